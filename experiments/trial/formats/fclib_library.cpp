// SPDX-License-Identifier: Zlib
#include "experiments/trial/formats/fclib_library.h"

#include <dlfcn.h>

#include <vector>

#include "framework/math/check.h"

#ifdef LPC_FCLIB
extern "C" {
#include <fclib.h>
#include <hdf5.h>
#include <hdf5_hl.h>
}
#endif

namespace lpc { inline namespace LPC_PRECISION {

#ifdef LPC_FCLIB
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr int kMostRows = 1 << 20;  // of a matrix: no sensible file has more
constexpr unsigned kReadOnly = 0;   // H5F_ACC_RDONLY, which is a function call
constexpr hid_t kDefault = 0;       // H5P_DEFAULT

void* library() {
  static void* const loaded = dlopen(LPC_FCLIB, RTLD_NOW | RTLD_LOCAL);
  if (!loaded) throw UserError("FCLIB cannot be loaded: " + std::string(dlerror()));
  return loaded;
}

/// A function of libfclib, or of the libraries that it needs.
template <class F>
F* found(const char* name) {
  void* const at = dlsym(library(), name);
  if (!at) throw UserError("FCLIB cannot be loaded: it has no " + std::string(name));
  return reinterpret_cast<F*>(at);
}
#define LPC_OF_FCLIB(function) found<decltype(function)>(#function)

/// Checks that all lists have the lengths that the file states: libfclib reads them into buffers of those lengths.
class Sizes {
 public:
  explicit Sizes(const std::string& path) {
    m_file = LPC_OF_FCLIB(H5Fopen)(path.c_str(), kReadOnly, kDefault);
    if (m_file < 0) throw UserError("it is damaged");
    local = has("/fclib_local") && !has("/fclib_global");
    if (!local && !has("/fclib_global")) throw UserError("it holds no problem of FCLIB");
    m_top = local ? "/fclib_local/" : "/fclib_global/";
    const long dimension = number(m_top + "spacedim");
    if (dimension != 2 && dimension != 3) throw UserError("its dimension is " + std::to_string(dimension));
    for (const char* of : {"info/title", "info/description", "info/math_info"}) {
      if (has(m_top + "info")) text(m_top + of);
    }
    local ? checkLocal(dimension) : checkGlobal(dimension);
    LPC_OF_FCLIB(H5Fclose)(m_file);
  }
  bool local = false;

 private:
  struct Size {
    long rows, columns;
  };

  void checkGlobal(long dimension) const {
    const Size m = matrix("M"), h = matrix("H"), g = has(m_top + "G") ? matrix("G") : Size{m.rows, 0};
    if (m.rows != m.columns || h.rows != m.rows || g.rows != m.rows || h.columns % dimension != 0 || m.rows == 0) {
      throw UserError("its matrices are of sizes that do not go together");
    }
    list("vectors/f", m.rows), list("vectors/w", h.columns), list("vectors/mu", h.columns / dimension);
    if (g.columns > 0) list("vectors/b", g.columns);
  }
  void checkLocal(long dimension) const {
    const bool joined = has(m_top + "V");
    if (joined != has(m_top + "R")) throw UserError("it has one of V and R, and not the other");
    const Size w = matrix("W"), v = joined ? matrix("V") : Size{w.rows, 0}, r = joined ? matrix("R") : Size{0, 0};
    if (w.rows != w.columns || v.rows != w.rows || r.rows != v.columns || r.columns != v.columns ||
        w.rows % dimension != 0 || w.rows == 0) {
      throw UserError("its matrices are of sizes that do not go together");
    }
    list("vectors/q", w.rows), list("vectors/mu", w.rows / dimension);
    if (joined) list("vectors/s", v.columns);
  }

  bool has(const std::string& path) const { return LPC_OF_FCLIB(H5Lexists)(m_file, path.c_str(), kDefault) > 0; }
  long lengthOf(const std::string& path) const {
    int rank = 0;
    hsize_t length = 0;
    H5T_class_t kind{};
    std::size_t bytes = 0;
    const bool read = LPC_OF_FCLIB(H5LTget_dataset_ndims)(m_file, path.c_str(), &rank) >= 0 && rank == 1 &&
                      LPC_OF_FCLIB(H5LTget_dataset_info)(m_file, path.c_str(), &length, &kind, &bytes) >= 0 &&
                      (kind == H5T_INTEGER || kind == H5T_FLOAT);
    if (!read) throw UserError("it has no list " + path);
    return static_cast<long>(length);
  }
  long number(const std::string& path) const {
    int value = 0;
    if (lengthOf(path) != 1 || LPC_OF_FCLIB(H5LTread_dataset_int)(m_file, path.c_str(), &value) < 0) {
      throw UserError("it has no number " + path);
    }
    return value;
  }
  /// libfclib reads at most one dimension.
  void text(const std::string& path) const {
    int rank = 0;
    const bool read =
        !has(path) || (LPC_OF_FCLIB(H5LTget_dataset_ndims)(m_file, path.c_str(), &rank) >= 0 && rank <= 1);
    if (!read) throw UserError("its " + path + " is no text");
  }
  void list(const std::string& name, long length) const {
    const long is = lengthOf(m_top + name);
    if (is == length) return;
    throw UserError("its " + name + " has " + std::to_string(is) + " numbers, not " + std::to_string(length));
  }
  Size matrix(const std::string& name) const {
    const std::string at = m_top + name;
    const long rows = number(at + "/m"), columns = number(at + "/n"), nz = number(at + "/nz"),
               most = number(at + "/nzmax");
    const bool sane = rows >= 0 && columns >= 0 && rows <= kMostRows && columns <= kMostRows && nz >= -2 && most >= nz;
    if (!sane) throw UserError("its matrix " + name + " is of no size");
    for (const char* of : {"/conditioning", "/determinant", "/rank"}) {  // libfclib has room for one number of each
      if (has(at + of)) number(at + of);
    }
    text(at + "/comment");
    list(name + "/p", nz >= 0 ? nz : (nz == -1 ? columns : rows) + 1);
    list(name + "/i", nz >= 0 ? nz : most), list(name + "/x", most);
    return {rows, columns};
  }

  hid_t m_file = -1;
  std::string m_top;  // of the form of this file
};

Sparse matrixOf(const fclib_matrix* from, const char* name) {
  const auto fail = [&] { throw UserError("its matrix " + std::string(name) + " is damaged"); };
  if (!from || !from->p || !from->i || !from->x) fail();
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int row, int column, double x) {
    if (row < 0 || row >= from->m || column < 0 || column >= from->n || !std::isfinite(x)) fail();
    entries.emplace_back(row, column, x);
  };
  const bool byColumn = from->nz == -1;
  for (int k = 0; k < from->nz; ++k) add(from->p[k], from->i[k], from->x[k]);
  for (int line = 0; from->nz < 0 && line < (byColumn ? from->n : from->m); ++line) {
    if (from->p[line] < 0 || from->p[line + 1] < from->p[line] || from->p[line + 1] > from->nzmax) fail();
    for (int k = from->p[line]; k < from->p[line + 1]; ++k) {
      byColumn ? add(from->i[k], line, from->x[k]) : add(line, from->i[k], from->x[k]);
    }
  }
  Sparse out(from->m, from->n);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

Eigen::VectorXd listOf(const double* from, Eigen::Index size, const char* name) {
  const Eigen::VectorXd out = size > 0 ? Eigen::Map<const Eigen::VectorXd>(from, size) : Eigen::VectorXd(size);
  if (!out.allFinite()) throw UserError("a number of its " + std::string(name) + " is not finite");
  return out;
}

/// A view of a matrix in compressed columns.
fclib_matrix viewOf(Sparse& from) {
  from.makeCompressed();
  fclib_matrix out{};
  out.nzmax = static_cast<int>(from.nonZeros()), out.m = static_cast<int>(from.rows());
  out.n = static_cast<int>(from.cols()), out.nz = -1;
  out.p = from.outerIndexPtr(), out.i = from.innerIndexPtr(), out.x = from.valuePtr();
  return out;
}

FclibLocal readLocal(const std::string& path) {
  const fclib_local* const from = LPC_OF_FCLIB(fclib_read_local)(path.c_str());
  const bool joined = from && from->V;
  if (!from || !from->q || !from->mu || (joined && (!from->R || !from->s))) throw UserError("it is damaged");
  FclibLocal out;
  out.dimension = from->spacedim, out.w = matrixOf(from->W, "W");
  out.v = joined ? matrixOf(from->V, "V") : Sparse(out.w.rows(), 0);
  out.r = joined ? matrixOf(from->R, "R") : Sparse(0, 0);
  out.q = listOf(from->q, out.w.rows(), "q"), out.s = listOf(from->s, out.v.cols(), "s");
  out.mu = listOf(from->mu, out.w.rows() / out.dimension, "mu");
  return out;
}

char ourTitle[] = "velocity problem of a step", noText[] = "";
fclib_info ourInfo{ourTitle, noText, noText};

}  // namespace

std::variant<FclibProblem, FclibLocal> readFclibHere(const std::string& path) {
  const Sizes checked(path);
  if (checked.local) return readLocal(path);
  const fclib_global* const from = LPC_OF_FCLIB(fclib_read_global)(path.c_str());
  if (!from || !from->f || !from->w || !from->mu || (from->G && !from->b)) throw UserError("it is damaged");
  FclibProblem out;
  out.dimension = from->spacedim;
  out.m = matrixOf(from->M, "M"), out.h = matrixOf(from->H, "H");
  out.g = from->G ? matrixOf(from->G, "G") : Sparse(out.m.rows(), 0);
  out.f = listOf(from->f, out.m.rows(), "f"), out.w = listOf(from->w, out.h.cols(), "w");
  out.mu = listOf(from->mu, out.h.cols() / out.dimension, "mu"), out.b = listOf(from->b, out.g.cols(), "b");
  return out;
}

void writeFclibHere(const std::string& path, FclibProblem& problem) {
  fclib_matrix m = viewOf(problem.m), h = viewOf(problem.h), g = viewOf(problem.g);
  fclib_global out{};
  const bool joined = problem.g.cols() > 0;
  out.M = &m, out.H = &h, out.G = joined ? &g : nullptr, out.b = joined ? problem.b.data() : nullptr;
  out.mu = problem.mu.data(), out.f = problem.f.data(), out.w = problem.w.data();
  out.spacedim = problem.dimension, out.info = &ourInfo;
  if (LPC_OF_FCLIB(fclib_write_global)(&out, path.c_str()) == 0) throw UserError("FCLIB cannot write it");
}

void writeFclibHere(const std::string& path, FclibLocal& problem) {
  fclib_matrix w = viewOf(problem.w), v = viewOf(problem.v), r = viewOf(problem.r);
  fclib_local out{};
  const bool joined = problem.v.cols() > 0;
  out.W = &w, out.V = joined ? &v : nullptr, out.R = joined ? &r : nullptr;
  out.mu = problem.mu.data(), out.q = problem.q.data(), out.s = joined ? problem.s.data() : nullptr;
  out.spacedim = problem.dimension, out.info = &ourInfo;
  if (LPC_OF_FCLIB(fclib_write_local)(&out, path.c_str()) == 0) throw UserError("FCLIB cannot write it");
}

#else

std::variant<FclibProblem, FclibLocal> readFclibHere(const std::string&) {
  throw UserError("it is a file of FCLIB, which this build is without; valid: one with libfclib-dev");
}
void writeFclibHere(const std::string&, FclibLocal&) {
  throw UserError("this build is without FCLIB; valid: one with libfclib-dev");
}
void writeFclibHere(const std::string&, FclibProblem&) {
  throw UserError("this build is without FCLIB; valid: one with libfclib-dev, or a file that ends in .json");
}

#endif

}}  // namespace lpc::LPC_PRECISION
