// SPDX-License-Identifier: Zlib
#pragma once

#include <cstddef>
#include <cstdint>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Frees the slot of a joint or force. Old handles become invalid.
template <class Record>
void freeRecord(Record& record) {
  const std::uint32_t next = record.generation + 1;
  record = Record{};
  record.generation = next;
}

/// True when the handle refers to a record in the table.
template <class Records, class Handle>
bool holdsRecord(const Records& records, Handle handle) {
  const auto i = static_cast<std::size_t>(handle.slot);
  return handle.slot >= 0 && i < records.size() && records[i].kind && records[i].generation == handle.generation;
}

}}  // namespace lpc::LPC_PRECISION
