// SPDX-License-Identifier: Zlib
// The linker treats two different functions of one name as one: it keeps the first that it meets, without a message.
// This program reads object files compiled without optimisation, where one definition gives one code. It names each
// weak function of LPC with different code in two files.
//
//   one_definition FOLDER...      exit code 1 when there is one
#include <elf.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <vector>

namespace {

struct Object {
  std::vector<char> bytes;

  const Elf64_Ehdr& header() const { return *reinterpret_cast<const Elf64_Ehdr*>(bytes.data()); }
  const Elf64_Shdr& section(std::size_t i) const {
    return reinterpret_cast<const Elf64_Shdr*>(bytes.data() + header().e_shoff)[i];
  }
  std::size_t sections() const { return header().e_shnum; }
  const char* text(std::size_t table, std::size_t at) const { return bytes.data() + section(table).sh_offset + at; }
  const char* sectionName(std::size_t i) const { return text(header().e_shstrndx, section(i).sh_name); }
  template <class T>
  std::pair<const T*, std::size_t> table(std::size_t i) const {
    return {reinterpret_cast<const T*>(bytes.data() + section(i).sh_offset), section(i).sh_size / sizeof(T)};
  }
};

// The code of a symbol: its bytes, and LPC's symbols to which they refer. References to other symbols and the places of
// constants differ between files and are left out.
std::string codeOf(const Object& o, std::size_t symbols, const Elf64_Sym& symbol) {
  const Elf64_Shdr& home = o.section(symbol.st_shndx);
  std::ostringstream out;
  out.write(o.bytes.data() + home.sh_offset + symbol.st_value, static_cast<std::streamsize>(symbol.st_size));
  for (std::size_t i = 0; i < o.sections(); ++i) {
    if (o.section(i).sh_type != SHT_RELA || o.section(i).sh_info != symbol.st_shndx) continue;
    const auto [relocations, count] = o.table<Elf64_Rela>(i);
    for (std::size_t k = 0; k < count; ++k) {
      const Elf64_Rela& r = relocations[k];
      if (r.r_offset < symbol.st_value || r.r_offset >= symbol.st_value + symbol.st_size) continue;
      const Elf64_Sym& to = o.table<Elf64_Sym>(symbols).first[ELF64_R_SYM(r.r_info)];
      const std::string name = o.text(o.section(symbols).sh_link, to.st_name);
      out << '|' << r.r_offset - symbol.st_value << ' ' << (name.find("N3lpc") == name.npos ? "" : name);
    }
  }
  return out.str();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: one_definition FOLDER...   folders with object files that were compiled with -O0\n";
    return 2;
  }
  struct First {
    std::string file, code;
  };
  std::map<std::string, First> known;
  int files = 0, different = 0;
  for (int a = 1; a < argc; ++a) {
    if (!std::filesystem::is_directory(argv[a])) {
      std::cerr << "one_definition: there is no folder " << argv[a] << '\n';
      return 2;
    }
    for (const auto& entry : std::filesystem::recursive_directory_iterator(argv[a])) {
      if (entry.path().extension() != ".o") continue;
      ++files;
      std::ifstream in(entry.path(), std::ios::binary);
      const Object o{{std::istreambuf_iterator<char>(in), {}}};
      if (o.bytes.size() < sizeof(Elf64_Ehdr) || std::memcmp(o.bytes.data(), ELFMAG, SELFMAG) != 0) continue;
      for (std::size_t i = 0; i < o.sections(); ++i) {
        if (o.section(i).sh_type != SHT_SYMTAB) continue;
        const auto [symbols, count] = o.table<Elf64_Sym>(i);
        for (std::size_t k = 0; k < count; ++k) {
          const Elf64_Sym& s = symbols[k];
          const bool weakFunction = ELF64_ST_BIND(s.st_info) == STB_WEAK && ELF64_ST_TYPE(s.st_info) == STT_FUNC;
          if (!weakFunction || s.st_shndx == SHN_UNDEF || s.st_shndx >= o.sections()) continue;
          const std::string name = o.text(o.section(i).sh_link, s.st_name);
          if (name.find("N3lpc") == name.npos) continue;  // templates of other libraries are not LPC's concern
          const std::string code = codeOf(o, i, s);
          const auto [first, fresh] = known.try_emplace(name, First{entry.path(), code});
          if (fresh || first->second.code == code) continue;
          ++different;
          std::cout << "two bodies for one name: " << name << "\n  " << first->second.file << "\n  "
                    << entry.path().string() << '\n';
        }
      }
    }
  }
  std::cout << files << " object files, " << known.size() << " weak functions of ours, " << different
            << " of two bodies\n";
  return files > 0 && different == 0 ? 0 : 1;
}
