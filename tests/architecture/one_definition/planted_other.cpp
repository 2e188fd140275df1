// SPDX-License-Identifier: Zlib
// Planted bug: planted_one.cpp has another function of this name (see main.cpp).
namespace lpc::planted {

inline double reach(double x) { return x + 2; }
double use_other(double x) { return reach(x); }

}  // namespace lpc::planted
