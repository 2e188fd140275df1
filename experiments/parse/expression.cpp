// SPDX-License-Identifier: Zlib
#include "experiments/parse/expression.h"

#include <muParser.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>

#include "framework/math/check.h"
#include "framework/math/names.h"
#include "framework/math/nesting.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// muParser's callbacks are plain functions; this is the random stream of the running evaluation.
thread_local Random* drawing = nullptr;
thread_local bool decided = false;
thread_local bool noNumber = false;  // a function had no value; min, max and comparisons would hide a NaN

double told(double value) {
  noNumber = noNumber || std::isnan(value);
  return value;
}

// Beyond this, sinCos is not a sine.
double withinTurns(double angle) { return std::abs(angle) <= kLargestAngle ? angle : std::nan(""); }

double sine(double x) {
  double s = 0, c = 1;
  sinCos(withinTurns(x), s, c);
  return told(s);
}
double cosine(double x) {
  double s = 0, c = 1;
  sinCos(withinTurns(x), s, c);
  return told(c);
}
double draw(double lo, double hi) {
  decided = decided || lo != hi;
  return drawing->uniform(lo, hi);
}
double root(double x) { return told(std::sqrt(x)); }
double magnitude(double x) { return std::fabs(x); }
double roundDown(double x) { return std::floor(x); }
double roundUp(double x) { return std::ceil(x); }
double remainderOf(double x, double y) { return told(x - y * std::floor(x / y)); }
double smaller(double x, double y) { return std::min(told(x), told(y)); }
double larger(double x, double y) { return std::max(told(x), told(y)); }

// 1 + 1/2 + ... + 1/n.
double harmonic(double n) {
  if (!(n >= 0 && n <= 1e6 && n == std::floor(n))) return told(std::nan(""));
  double sum = 0;
  for (double k = n; k > 0; --k) sum += 1 / k;
  return sum;
}

constexpr const char* kFunctions = "sin cos sqrt abs floor ceil min max mod rand harmonic pi";

bool inName(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

// Finds mistakes that muParser accepts silently: an assignment, which would change a variable for later expressions; a
// comma outside a function, after which only the last number counts; two comparisons in a row, the second of which
// compares a 0 or 1. Returns the reason, or an empty text.
std::string slipIn(const std::string& text) {
  struct Level {
    bool function = false, compared = false;
  };
  std::vector<Level> levels(1);  // one per open parenthesis
  char last = ' ';               // ignoring spaces
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool equals = i + 1 < text.size() && text[i + 1] == '=';
    if (c == '(') {
      levels.push_back({inName(last), false});
      if (levels.size() > kMostNested + 1)
        return "parentheses nested more than " + std::to_string(kMostNested) + " deep";
    } else if (c == ')') {
      if (levels.size() > 1) levels.pop_back();
    } else if (c == ',') {
      if (!levels.back().function) return "a comma outside of a function; valid: a point for decimals, as in 0.5";
      levels.back().compared = false;
    } else if (c == '?' || c == ':' || c == '&' || c == '|') {
      levels.back().compared = false;
    } else if (c == '=' && !equals) {
      return "'=' in an expression, which changes nothing; valid: '==', which compares";
    } else if (c == '=' || c == '<' || c == '>' || (c == '!' && equals)) {
      if (levels.back().compared) return "two comparisons in a row; valid: such as 'a < b && b < c'";
      levels.back().compared = true;
      i += equals;
    }
    const bool space = std::isspace(static_cast<unsigned char>(c));
    if (!space && std::iscntrl(static_cast<unsigned char>(c)))
      return "a control character";  // parsing stops at a zero byte
    if (!space) last = c;
  }
  return "";
}

}  // namespace

struct Expressions::Compiled {
  mu::Parser parser;
};

Expressions::Expressions(std::uint64_t seed) : m_random(seed) {}
Expressions::~Expressions() = default;

void Expressions::setGlobal(const std::string& name, double value) { m_globals[name] = value; }

void Expressions::setLocal(const std::string& name, double value) { m_locals[name] = value; }

void Expressions::forgetLocals() {
  m_compiled.clear();  // they point to the locals
  m_locals.clear();
}

bool Expressions::knows(const std::string& name) const { return m_globals.count(name) || m_locals.count(name); }

void Expressions::checkName(const std::string& name) {
  bool taken = std::isdigit(static_cast<unsigned char>(name.empty() ? '0' : name[0]));
  for (const char c : name) taken = taken || !inName(c);
  if (taken) throw UserError("'" + name + "' is no name for a number; valid: letters, digits and _, no digit first");
  std::istringstream functions(kFunctions);
  for (std::string function; functions >> function;) {
    if (name == function) throw UserError("'" + name + "' is already the name of something else");
  }
}

double Expressions::evaluate(const std::string& text) {
  const double value = valueOf(text);
  if (!std::isfinite(value) || noNumber) {
    throw UserError("'" + oneLine(text) +
                    "' is not a finite number, or a part of it is none, such as the sine of over " +
                    std::to_string(static_cast<long>(kLargestAngle)) + " rad");
  }
  return value;
}

void Expressions::check(const std::string& text) {
  aside([&] { valueOf(text); });
}

double Expressions::valueOf(const std::string& text) {
  drawing = &m_random, decided = m_drew, noNumber = false;
  try {
    auto& compiled = m_compiled[text];
    if (!compiled) {
      if (const std::string slip = slipIn(text); !slip.empty()) throw UserError("'" + oneLine(text) + "': " + slip);
      compiled = std::make_unique<Compiled>();
      mu::Parser& p = compiled->parser;
      p.ClearFun();  // libm's functions have other last digits on other machines: only ours remain
      p.ClearConst();
      p.DefineConst("pi", 3.14159265358979323846);
      // false: never folded into a constant. Two calls of rand must be two calls, and a call without a value must be
      // reported at each evaluation, but not in a branch that is not taken.
      p.DefineFun("sin", sine, false);
      p.DefineFun("cos", cosine, false);
      p.DefineFun("sqrt", root, false);
      p.DefineFun("abs", magnitude);
      p.DefineFun("floor", roundDown);
      p.DefineFun("ceil", roundUp);
      p.DefineFun("mod", remainderOf, false);
      p.DefineFun("min", smaller, false);
      p.DefineFun("max", larger, false);
      p.DefineFun("rand", draw, false);
      p.DefineFun("harmonic", harmonic, false);
      for (auto& [name, value] : m_globals) p.DefineVar(name, &value);
      for (auto& [name, value] : m_locals) p.DefineVar(name, &value);
      p.SetExpr(text);
    }
    const double value = compiled->parser.Eval();
    m_drew = decided;
    return value;
  } catch (const mu::Parser::exception_type& e) {
    m_compiled.erase(text);
    std::string names;
    for (const auto* scope : {&m_globals, &m_locals}) {
      for (const auto& [name, value] : *scope) names += " " + name;
    }
    throw UserError("'" + oneLine(text) + "': " + e.GetMsg() + " Valid names:" + names + " and " + kFunctions);
  }
}

}}  // namespace lpc::LPC_PRECISION
