// SPDX-License-Identifier: Zlib
// A joint's kind and parameters from its record, for engines with their own parameters.
#pragma once

#include <algorithm>
#include <charconv>
#include <initializer_list>
#include <string>
#include <string_view>

#include "framework/problem/joint.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
class JointSpec {
 public:
  /// `engine` is the name in messages.
  JointSpec(const JointRecord<D>& joint, std::string engine)
      : m_spec(Spec::parse(joint.spec)),
        m_usual(Registry::instance().find(StageKind::joint, D, kind()).canonical({kind(), {}})),
        m_engine(std::move(engine)) {}

  const std::string& kind() const { return m_spec.name; }
  /// Precondition: the kind has such a parameter.
  const std::string& text(std::string_view parameter) const {
    const Spec* value = m_spec.find(parameter);
    LPC_ASSERT(value);
    return value->name;
  }
  Real real(std::string_view parameter) const {
    const std::string& s = text(parameter);
    Real value = 0;
    [[maybe_unused]] const auto end = std::from_chars(s.data(), s.data() + s.size(), value);
    LPC_ASSERT(end.ec == std::errc());
    return value;
  }

  /// True when the parameter has its default value.
  bool usual(std::string_view parameter) const { return text(parameter) == m_usual.find(parameter)->name; }

  /// Throws UserError unless every other parameter has its default: also a parameter added to the kind later.
  void takes(std::initializer_list<std::string_view> parameters) const {
    for (const Spec::Field& f : m_spec.fields) {
      const bool taken = std::find(parameters.begin(), parameters.end(), f.key) != parameters.end();
      if (!taken && !usual(f.key)) {
        refuse("its " + kind() + " joint has no '" + f.key + "'; valid: " + f.key + "=" + m_usual.find(f.key)->name);
      }
    }
  }
  [[noreturn]] void refuse(const std::string& why) const { throw UserError(m_engine + ": " + why); }

 private:
  Spec m_spec, m_usual;
  std::string m_engine;
};

}}  // namespace lpc::LPC_PRECISION
