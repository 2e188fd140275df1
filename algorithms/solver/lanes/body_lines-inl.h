// SPDX-License-Identifier: Zlib
// Vectors with one value per lane, and bodies: the lines of several bodies, loaded whole and transposed in registers.
#if defined(LPC_BODY_LINES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LPC_BODY_LINES_INL_H
#undef LPC_BODY_LINES_INL_H
#else
#define LPC_BODY_LINES_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#include "algorithms/solver/lanes/contact_blocks.h"

HWY_BEFORE_NAMESPACE();
namespace lpc { inline namespace LPC_PRECISION { namespace solver { namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <int N, class T>
struct LaneVec {
  using V = hn::Vec<T>;
  V x[N];
  HWY_INLINE V& operator[](int k) { return x[k]; }
  HWY_INLINE const V& operator[](int k) const { return x[k]; }

  friend HWY_INLINE LaneVec operator+(const LaneVec& a, const LaneVec& b) {
    LaneVec c;
    for (int k = 0; k < N; ++k) c[k] = a[k] + b[k];
    return c;
  }
  friend HWY_INLINE LaneVec operator-(const LaneVec& a, const LaneVec& b) {
    LaneVec c;
    for (int k = 0; k < N; ++k) c[k] = a[k] - b[k];
    return c;
  }
  friend HWY_INLINE LaneVec operator*(V s, const LaneVec& a) {
    LaneVec c;
    for (int k = 0; k < N; ++k) c[k] = s * a[k];
    return c;
  }
  friend HWY_INLINE V dot(const LaneVec& a, const LaneVec& b) {
    if constexpr (N == 1) {
      return a[0] * b[0];
    } else if constexpr (N == 2) {
      return a[0] * b[0] + a[1] * b[1];
    } else {
      return sum(a[0] * b[0], a[1] * b[1], a[2] * b[2]);
    }
  }
  /// Adds in Eigen's order: in f64 Eigen adds the first two entries first.
  static HWY_INLINE V sum(V a, V b, V c) { return sizeof(Real) == 8 ? (a + b) + c : a + (b + c); }
};

template <class T>
HWY_INLINE LaneVec<3, T> cross(const LaneVec<3, T>& a, const LaneVec<3, T>& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}

/// By column.
template <int N, class T>
struct LaneInertia {
  using V = hn::Vec<T>;
  V v[N * N];

  HWY_INLINE LaneVec<N, T> operator*(const LaneVec<N, T>& a) const {
    if constexpr (N == 1) {
      return {{v[0] * a[0]}};
    } else {
      LaneVec<3, T> out;
      for (int k = 0; k < 3; ++k) {
        const V x = v[k] * a[0], y = v[3 + k] * a[1], z = v[6 + k] * a[2];
        out[k] = k < 2 ? LaneVec<3, T>::sum(x, y, z) : x + (y + z);
      }
      return out;
    }
  }
};

#if HWY_TARGET == HWY_SCALAR
template <int kScale = 1, class T>
HWY_INLINE void loadFour(T tag, const Real* base, const std::int32_t* offsets, hn::Vec<T>* out) {
  for (int k = 0; k < 4; ++k) out[k] = hn::LoadU(tag, base + kScale * offsets[0] + k);
}
template <class T>
HWY_INLINE void storeFour(T tag, const hn::Vec<T>* in, Real* base, const std::int32_t* offsets) {
  for (int k = 0; k < 4; ++k) hn::StoreU(in[k], tag, base + offsets[0] + k);
}
#else
/// Transposes each group of four lines by four columns within registers: it is its own inverse.
template <class T>
HWY_INLINE void transposeFour(T tag, const hn::Vec<T>* in, hn::Vec<T>* out) {
  if constexpr (sizeof(Real) == 8) {  // four lanes: line i in, column i out
    const auto low0 = hn::InterleaveLower(tag, in[0], in[1]), high0 = hn::InterleaveUpper(tag, in[0], in[1]);
    const auto low1 = hn::InterleaveLower(tag, in[2], in[3]), high1 = hn::InterleaveUpper(tag, in[2], in[3]);
    out[0] = hn::ConcatLowerLower(tag, low1, low0), out[2] = hn::ConcatUpperUpper(tag, low1, low0);
    out[1] = hn::ConcatLowerLower(tag, high1, high0), out[3] = hn::ConcatUpperUpper(tag, high1, high0);
  } else {  // within blocks of four lanes
    const hn::Repartition<double, T> pairs;
    const auto low0 = hn::BitCast(pairs, hn::InterleaveLower(tag, in[0], in[1]));
    const auto low1 = hn::BitCast(pairs, hn::InterleaveLower(tag, in[2], in[3]));
    const auto high0 = hn::BitCast(pairs, hn::InterleaveUpper(tag, in[0], in[1]));
    const auto high1 = hn::BitCast(pairs, hn::InterleaveUpper(tag, in[2], in[3]));
    out[0] = hn::BitCast(tag, hn::InterleaveLower(pairs, low0, low1));
    out[1] = hn::BitCast(tag, hn::InterleaveUpper(pairs, low0, low1));
    out[2] = hn::BitCast(tag, hn::InterleaveLower(pairs, high0, high1));
    out[3] = hn::BitCast(tag, hn::InterleaveUpper(pairs, high0, high1));
  }
}

/// Four numbers of each lane, at base + offsets[lane]: column k of the lines becomes out[k].
template <int kScale = 1, class T>
HWY_INLINE void loadFour(T tag, const Real* base, const std::int32_t* offsets, hn::Vec<T>* out) {
  constexpr std::size_t n = hn::MaxLanes(T());
  if constexpr (n == 1) {
    for (int k = 0; k < 4; ++k) out[k] = hn::LoadU(tag, base + kScale * offsets[0] + k);
  } else if constexpr (n == 4) {
    hn::Vec<T> line[4];
    for (int i = 0; i < 4; ++i) line[i] = hn::LoadU(tag, base + kScale * offsets[i]);
    transposeFour(tag, line, out);
  } else if constexpr (n == 8 && sizeof(Real) == 4) {
    const hn::Half<T> half;
    hn::Vec<T> line[4];
    for (int i = 0; i < 4; ++i) {
      line[i] = hn::Combine(tag, hn::LoadU(half, base + kScale * offsets[i + 4]),
                            hn::LoadU(half, base + kScale * offsets[i]));
    }
    transposeFour(tag, line, out);
  } else if constexpr (n == 2) {
    for (int k = 0; k < 4; k += 2) {
      const auto first = hn::LoadU(tag, base + kScale * offsets[0] + k),
                 second = hn::LoadU(tag, base + kScale * offsets[1] + k);
      out[k] = hn::InterleaveLower(tag, first, second), out[k + 1] = hn::InterleaveUpper(tag, first, second);
    }
  } else {
    HWY_ALIGN Real four[4 * n];
    for (std::size_t i = 0; i < n; ++i) {
      for (int k = 0; k < 4; ++k) four[4 * i + static_cast<std::size_t>(k)] = base[kScale * offsets[i] + k];
    }
    hn::LoadInterleaved4(tag, four, out[0], out[1], out[2], out[3]);
  }
}
/// The inverse.
template <class T>
HWY_INLINE void storeFour(T tag, const hn::Vec<T>* in, Real* base, const std::int32_t* offsets) {
  constexpr std::size_t n = hn::MaxLanes(T());
  if constexpr (n == 1) {
    for (int k = 0; k < 4; ++k) hn::StoreU(in[k], tag, base + offsets[0] + k);
  } else if constexpr (n == 4) {
    hn::Vec<T> line[4];
    transposeFour(tag, in, line);
    for (int i = 0; i < 4; ++i) hn::StoreU(line[i], tag, base + offsets[i]);
  } else if constexpr (n == 8 && sizeof(Real) == 4) {
    const hn::Half<T> half;
    hn::Vec<T> line[4];
    transposeFour(tag, in, line);
    for (int i = 0; i < 4; ++i) {
      hn::StoreU(hn::LowerHalf(half, line[i]), half, base + offsets[i]);
      hn::StoreU(hn::UpperHalf(half, line[i]), half, base + offsets[i + 4]);
    }
  } else if constexpr (n == 2) {
    for (int k = 0; k < 4; k += 2) {
      hn::StoreU(hn::InterleaveLower(tag, in[k], in[k + 1]), tag, base + offsets[0] + k);
      hn::StoreU(hn::InterleaveUpper(tag, in[k], in[k + 1]), tag, base + offsets[1] + k);
    }
  } else {
    HWY_ALIGN Real four[4 * n];
    hn::StoreInterleaved4(in[0], in[1], in[2], in[3], tag, four);
    for (std::size_t i = 0; i < n; ++i) {
      for (int k = 0; k < 4; ++k) base[offsets[i] + k] = four[4 * i + static_cast<std::size_t>(k)];
    }
  }
}
#endif

/// A line of ContactBlocks::motion or pose in each lane.
template <int D, class T>
struct LaneBody {
  using V = hn::Vec<T>;
  static constexpr int kAng = kAngDim<D>;
  V x[kLine<D>];

  HWY_INLINE void load(const Real* lines, const std::int32_t* offsets) {
    for (int k = 0; k < kLine<D>; k += 4) loadFour(T(), lines + k, offsets, x + k);
  }
  HWY_INLINE void store(Real* lines, const std::int32_t* offsets) const {
    for (int k = 0; k < kLine<D>; k += 4) storeFour(T(), x + k, lines + k, offsets);
  }
  /// Velocity or displacement.
  HWY_INLINE LaneVec<D, T> v() const {
    LaneVec<D, T> out;
    for (int k = 0; k < D; ++k) out[k] = x[k];
    return out;
  }
  /// Angular velocity.
  HWY_INLINE LaneVec<kAng, T> w() const {
    LaneVec<kAng, T> out;
    for (int k = 0; k < kAng; ++k) out[k] = x[kLineTurn<D> + k];
    return out;
  }
  HWY_INLINE void setV(const LaneVec<D, T>& v) {
    for (int k = 0; k < D; ++k) x[k] = v[k];
  }
  HWY_INLINE void setW(const LaneVec<kAng, T>& w) {
    for (int k = 0; k < kAng; ++k) x[kLineTurn<D> + k] = w[k];
  }
};

/// A direction of the body's frame in world axes, by the rotation of its pose: Rot::operator* in lanes.
template <class T>
HWY_INLINE LaneVec<2, T> turned(const LaneBody<2, T>& pose, const LaneVec<2, T>& v) {
  const auto c = pose.x[2], s = pose.x[3];
  return {{c * v[0] - s * v[1], s * v[0] + c * v[1]}};
}
template <class T>
HWY_INLINE LaneVec<3, T> turned(const LaneBody<3, T>& pose, const LaneVec<3, T>& v) {
  const LaneVec<3, T> u = {{pose.x[5], pose.x[6], pose.x[7]}};
  const LaneVec<3, T> t = hn::Set(T(), 2) * cross(u, v);
  return (v + pose.x[4] * t) + cross(u, t);
}

}}}}  // namespace lpc::LPC_PRECISION::solver::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
