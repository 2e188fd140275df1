// SPDX-License-Identifier: Zlib
#include "experiments/trial/plugin.h"

#include <dlfcn.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr std::string_view kMark = "LPC-ABI|";

std::string abiOf(const std::string& path) {
  std::error_code absent;  // a pipe may block, and a device may never end
  if (std::filesystem::exists(path, absent) && !std::filesystem::is_regular_file(path, absent)) {
    throw UserError("plugin " + path + ": it is not a regular file");
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) throw UserError("plugin " + path + ": cannot be read: " + std::strerror(errno));
  std::ostringstream bytes;
  bytes << in.rdbuf();
  const std::string all = bytes.str();
  const std::size_t at = all.find(kMark);
  if (at == std::string::npos) {
    throw UserError("plugin " + path +
                    ": it does not define lpc_abi; put LPC_PLUGIN; (framework/stage/plugin.h) into one source file");
  }
  return all.substr(at, all.find('\0', at) - at);
}

}  // namespace

std::string pluginPrecision(const std::string& path) {
  const std::string abi = abiOf(path);
  const std::size_t first = abi.find('|', kMark.size());
  const std::size_t second = abi.find('|', first + 1);
  return second == std::string::npos ? "" : abi.substr(first + 1, second - first - 1);
}

void loadPlugin(const std::string& path) {
  const std::string abi = abiOf(path);
  if (abi != LPC_ABI_TEXT) {
    throw UserError("plugin " + path + ": it was built as '" + abi.substr(kMark.size()) + "'; valid: '" +
                    std::string(LPC_ABI_TEXT).substr(kMark.size()) + "'");
  }
  void* library = dlopen(std::filesystem::absolute(path).c_str(), RTLD_NOW | RTLD_GLOBAL);
  if (!library) throw UserError("plugin " + path + ": " + dlerror());
  if (!dlsym(library, "lpc_abi")) throw UserError("plugin " + path + ": it does not export the symbol lpc_abi");
}

}}  // namespace lpc::LPC_PRECISION
