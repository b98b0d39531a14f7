// SPDX-License-Identifier: MIT
// Names of this executable's functions, local ones too, from its ELF symbol table.
#include <elf.h>
#include <link.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <vector>

#include "tests/cuda_host/ptx_kernels.hpp"

namespace rptv::cuda_host {
namespace {

std::uintptr_t load_address() {
  std::uintptr_t address = 0;
  dl_iterate_phdr(
      [](dl_phdr_info* first, std::size_t, void* found) {
        *static_cast<std::uintptr_t*>(found) = first->dlpi_addr;
        return 1;  // the executable comes first
      },
      &address);
  return address;
}

template <class T>
T read_at(const std::vector<char>& file, std::size_t offset) {
  T value{};
  if (offset + sizeof(T) <= file.size()) std::memcpy(&value, file.data() + offset, sizeof(T));
  return value;
}

std::map<std::uintptr_t, std::string> functions() {
  std::ifstream stream("/proc/self/exe", std::ios::binary);
  const std::vector<char> file((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  const auto header = read_at<Elf64_Ehdr>(file, 0);
  std::map<std::uintptr_t, std::string> found;
  for (std::size_t section = 0; section < header.e_shnum; ++section) {
    const auto symbols = read_at<Elf64_Shdr>(file, header.e_shoff + section * sizeof(Elf64_Shdr));
    if (symbols.sh_type != SHT_SYMTAB) continue;
    const auto names = read_at<Elf64_Shdr>(file, header.e_shoff + symbols.sh_link * sizeof(Elf64_Shdr));
    for (std::size_t i = 0; i < symbols.sh_size / sizeof(Elf64_Sym); ++i) {
      const auto symbol = read_at<Elf64_Sym>(file, symbols.sh_offset + i * sizeof(Elf64_Sym));
      if (ELF64_ST_TYPE(symbol.st_info) != STT_FUNC || symbol.st_value == 0) continue;
      found.emplace(symbol.st_value, file.data() + names.sh_offset + symbol.st_name);
    }
  }
  return found;
}

}  // namespace

std::string symbol_at(const void* function) {
  static const std::map<std::uintptr_t, std::string> all = functions();
  const auto found = all.find(reinterpret_cast<std::uintptr_t>(function) - load_address());
  return found == all.end() ? "" : found->second;
}

}  // namespace rptv::cuda_host
