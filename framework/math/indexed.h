// SPDX-License-Identifier: Zlib
// Containers of the standard library with operator[] for the project's own indices: slots, counts and dimensions are
// signed. Everything else is unchanged, and each converts to its base.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "framework/math/check.h"

namespace lpc {

template <class T>
concept AnyIndex = std::integral<T> || std::is_enum_v<T>;

/// Converts i to std::size_t; asserts that it is below `size`.
template <AnyIndex I>
constexpr std::size_t indexOf(I i, [[maybe_unused]] std::size_t size) {
  LPC_ASSERT(static_cast<std::size_t>(i) < size);
  return static_cast<std::size_t>(i);
}

template <class T>
struct IndexedVector : std::vector<T> {
  using std::vector<T>::vector;
  IndexedVector() = default;
  IndexedVector(std::vector<T> from) : std::vector<T>(std::move(from)) {}
  /// Keeps its memory, as std::vector's assignment does.
  template <std::same_as<std::vector<T>> V>
  IndexedVector& operator=(const V& from) {
    std::vector<T>::operator=(from);
    return *this;
  }
  template <std::same_as<std::vector<T>> V>
  IndexedVector& operator=(V&& from) {
    std::vector<T>::operator=(std::move(from));
    return *this;
  }

  template <AnyIndex I>
  T& operator[](I i) {
    return this->data()[indexOf(i, this->size())];
  }
  template <AnyIndex I>
  const T& operator[](I i) const {
    return this->data()[indexOf(i, this->size())];
  }
  /// `count` elements, starting at `first`.
  template <AnyIndex I>
  std::span<T> part(I first, I count) {
    return std::span<T>(*this).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count));
  }
  template <AnyIndex I>
  std::span<const T> part(I first, I count) const {
    return std::span<const T>(*this).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count));
  }
};

template <class T>
struct IndexedSpan : std::span<T> {
  using std::span<T>::span;
  constexpr IndexedSpan() = default;
  constexpr IndexedSpan(std::span<T> from) : std::span<T>(from) {}

  template <AnyIndex I>
  constexpr T& operator[](I i) const {
    return this->data()[indexOf(i, this->size())];
  }
  /// `count` elements, starting at `first`.
  template <AnyIndex I>
  constexpr std::span<T> part(I first, I count) const {
    return this->subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count));
  }
};

template <class T, int N>
struct IndexedArray : std::array<T, static_cast<std::size_t>(N)> {
  template <AnyIndex I>
  constexpr T& operator[](I i) {
    return std::array<T, static_cast<std::size_t>(N)>::operator[](indexOf(i, this->size()));
  }
  template <AnyIndex I>
  constexpr const T& operator[](I i) const {
    return std::array<T, static_cast<std::size_t>(N)>::operator[](indexOf(i, this->size()));
  }
};

}  // namespace lpc

template <class T, int N>
struct std::tuple_size<lpc::IndexedArray<T, N>> : std::tuple_size<std::array<T, static_cast<std::size_t>(N)>> {};
template <std::size_t I, class T, int N>
struct std::tuple_element<I, lpc::IndexedArray<T, N>> {
  using type = T;
};
