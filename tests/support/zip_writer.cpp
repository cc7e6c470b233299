#include "tests/support/zip_writer.h"

#include <zlib.h>

namespace test_support {
namespace {

void put(std::string& bytes, uint32_t value, int count) {
    for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> (8 * i));
}

uint32_t crc_of(const std::string& text) {
    return static_cast<uint32_t>(
        crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size())));
}

/// A deflate stream without the header of zlib.
std::string deflated(const std::string& text) {
    z_stream stream{};
    deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY);
    std::string packed(deflateBound(&stream, text.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream.avail_in = static_cast<uInt>(text.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    deflate(&stream, Z_FINISH);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    return packed;
}

struct Entry {
    const std::string& name;
    const std::string& text;
    const std::string& packed;
    uint16_t method, flags;
};

/// The part that the header of a file and its line in the directory share.
void put_entry(std::string& bytes, const Entry& entry) {
    put(bytes, 20, 2);
    put(bytes, entry.flags, 2);
    put(bytes, entry.method, 2);
    put(bytes, 0, 4);
    put(bytes, crc_of(entry.text), 4);
    put(bytes, static_cast<uint32_t>(entry.packed.size()), 4);
    put(bytes, static_cast<uint32_t>(entry.text.size()), 4);
    put(bytes, static_cast<uint32_t>(entry.name.size()), 2);
    put(bytes, 0, 2);
}

std::string archive_of(const std::vector<std::pair<std::string, std::string>>& files, bool packs,
                       uint16_t flags) {
    std::string bytes, directory;
    for (const auto& [name, text] : files) {
        const std::string packed = packs ? deflated(text) : text;
        const Entry entry{name, text, packed, static_cast<uint16_t>(packs ? 8 : 0), flags};
        put(directory, 0x02014b50, 4);
        put(directory, 20, 2);
        put_entry(directory, entry);
        directory.append(10, '\0'); // comment, disk, attributes
        put(directory, static_cast<uint32_t>(bytes.size()), 4);
        directory += name;
        put(bytes, 0x04034b50, 4);
        put_entry(bytes, entry);
        bytes += name + packed;
    }
    const auto at = static_cast<uint32_t>(bytes.size());
    bytes += directory;
    put(bytes, 0x06054b50, 4);
    put(bytes, 0, 4);
    put(bytes, static_cast<uint32_t>(files.size()), 2);
    put(bytes, static_cast<uint32_t>(files.size()), 2);
    put(bytes, static_cast<uint32_t>(directory.size()), 4);
    put(bytes, at, 4);
    put(bytes, 0, 2);
    return bytes;
}

} // namespace

std::string zip_of(const std::vector<std::pair<std::string, std::string>>& files, uint16_t flags) {
    return archive_of(files, false, flags);
}

std::string packed_zip_of(const std::vector<std::pair<std::string, std::string>>& files) {
    return archive_of(files, true, 0);
}

} // namespace test_support
