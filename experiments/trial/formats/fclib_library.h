// SPDX-License-Identifier: Zlib
// Isolates libfclib: it is loaded on demand, by a process that does nothing else (library_process.h).
#pragma once

#include <Eigen/Sparse>
#include <string>
#include <variant>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// FCLIB's global form: M v = H r + G l + f, u = H^T v + w, G^T v + b = 0, and r in the cones of mu.
struct FclibProblem {
  int dimension = 0;  // of a contact
  Eigen::SparseMatrix<double> m, h, g;
  Eigen::VectorXd f, w, b, mu;  // G without columns: no equality rows
};

/// Its local form: u = W r + V l + q, V^T r + R l + s = 0, and r in the cones of mu.
struct FclibLocal {
  int dimension = 0;
  Eigen::SparseMatrix<double> w, v, r;
  Eigen::VectorXd q, s, mu;  // V without columns: no equality rows
};

/// All functions are called inside inItsProcess(), and throw UserError.
std::variant<FclibProblem, FclibLocal> readFclibHere(const std::string& path);
void writeFclibHere(const std::string& path, FclibProblem& problem);
void writeFclibHere(const std::string& path, FclibLocal& problem);

}}  // namespace lpc::LPC_PRECISION
