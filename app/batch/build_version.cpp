#include "app/batch/build_version.h"

#include <algorithm>
#include <random>
#include <span>

#include <elf.h>
#include <fmt/format.h>
#include <link.h>

#include "app/session/digest.h"
#include "app/version.h"

namespace app {
namespace {

/// The build-id that the linker puts into a program: a digest of what it linked.
std::string build_id_in(std::span<const char> notes) {
    while (notes.size() >= sizeof(ElfW(Nhdr))) {
        ElfW(Nhdr) note;
        std::copy_n(notes.data(), sizeof note, reinterpret_cast<char*>(&note));
        const size_t name = sizeof note;
        const size_t description = name + (note.n_namesz + 3) / 4 * 4;
        const size_t next = description + (note.n_descsz + 3) / 4 * 4;
        if (next > notes.size()) return {};
        if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4) {
            std::string id;
            for (const char byte : notes.subspan(description, note.n_descsz))
                id += fmt::format("{:02x}", static_cast<unsigned char>(byte));
            return id;
        }
        notes = notes.subspan(next);
    }
    return {};
}

/// Called for each loaded file; the first is the program itself.
int take_build_id(dl_phdr_info* info, size_t, void* taken) {
    for (const ElfW(Phdr) & part : std::span(info->dlpi_phdr, info->dlpi_phnum)) {
        if (part.p_type != PT_NOTE) continue;
        const auto* notes = reinterpret_cast<const char*>(info->dlpi_addr + part.p_vaddr);
        std::string& id = *static_cast<std::string*>(taken);
        if (id.empty()) id = build_id_in({notes, part.p_memsz});
    }
    return 1; // no further file
}

std::string build_name() {
    std::string id;
    dl_iterate_phdr(&take_build_id, &id);
    if (id.empty()) id = sha256_of_file("/proc/self/exe");
    // Who does not know its build must not take another's results for its own.
    return id.empty() ? fmt::format("unknown {:x}", std::random_device()()) : id;
}

} // namespace

const std::string& build_version() {
    static const std::string known = fmt::format("{} {}", version, build_name());
    return known;
}

} // namespace app
