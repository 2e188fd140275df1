// SPDX-License-Identifier: Zlib
#include "experiments/parse/expression.h"

#include <muParser.h>

#include <algorithm>
#include <cmath>

#include "framework/check.h"

namespace lpc::inline LPC_PRECISION {
namespace {

// muParser's callbacks are plain functions; the stream that `rand` draws from is that of the evaluation under way.
thread_local Random* drawing = nullptr;
thread_local bool decided = false;

double sine(double x) {
  double s = 0, c = 1;
  sinCos(x, s, c);
  return s;
}
double cosine(double x) {
  double s = 0, c = 1;
  sinCos(x, s, c);
  return c;
}
double draw(double lo, double hi) {
  decided = decided || lo != hi;
  return drawing->uniform(lo, hi);
}
double root(double x) { return std::sqrt(x); }
double magnitude(double x) { return std::fabs(x); }
double roundDown(double x) { return std::floor(x); }
double roundUp(double x) { return std::ceil(x); }
double remainderOf(double x, double y) { return x - y * std::floor(x / y); }
double smaller(double x, double y) { return std::min(x, y); }
double larger(double x, double y) { return std::max(x, y); }

constexpr const char* kFunctions = "sin cos sqrt abs floor ceil min max mod rand pi";

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

double Expressions::evaluate(const std::string& text) {
  drawing = &m_random, decided = m_drew;
  try {
    auto& compiled = m_compiled[text];
    if (!compiled) {
      compiled = std::make_unique<Compiled>();
      mu::Parser& p = compiled->parser;
      p.ClearFun();  // libm's functions end in other digits on other machines: only ours are left
      p.ClearConst();
      p.DefineConst("pi", 3.14159265358979323846);
      p.DefineFun("sin", sine);
      p.DefineFun("cos", cosine);
      p.DefineFun("sqrt", root);
      p.DefineFun("abs", magnitude);
      p.DefineFun("floor", roundDown);
      p.DefineFun("ceil", roundUp);
      p.DefineFun("mod", remainderOf);
      p.DefineFun("min", smaller);
      p.DefineFun("max", larger);
      p.DefineFun("rand", draw, false);  // false: two calls are two numbers, never folded into one
      for (auto& [name, value] : m_globals) p.DefineVar(name, &value);
      for (auto& [name, value] : m_locals) p.DefineVar(name, &value);
      p.SetExpr(text);
    }
    const double value = compiled->parser.Eval();
    m_drew = decided;
    if (!std::isfinite(value)) throw UserError("'" + text + "' is not a finite number");
    return value;
  } catch (const mu::Parser::exception_type& e) {
    m_compiled.erase(text);
    std::string names;
    for (const auto* scope : {&m_globals, &m_locals}) {
      for (const auto& [name, value] : *scope) names += " " + name;
    }
    throw UserError("'" + text + "': " + e.GetMsg() + " Valid names:" + names + " and " + kFunctions);
  }
}

}  // namespace lpc::inline LPC_PRECISION
