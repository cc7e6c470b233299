#include "core/formats/zip_archive.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <unzip.h> // minizip

#include "core/base/file_reads.h"

namespace core {
namespace {

constexpr size_t largest_archive = size_t(256) << 20; // bytes
constexpr size_t most_members = 10000;
constexpr size_t longest_member_name = 4096;

/// A read position in bytes that outlive it.
struct ByteStream {
    const std::string* bytes;
    size_t at = 0;
};

// The functions through which minizip reads. `opaque` is the stream, and so is the file.

void* open_bytes(void* opaque, const void*, int) { return opaque; }

uLong read_bytes(void*, void* file, void* buffer, uLong size) {
    auto& stream = *static_cast<ByteStream*>(file);
    const size_t count = std::min<size_t>(size, stream.bytes->size() - stream.at);
    std::memcpy(buffer, stream.bytes->data() + stream.at, count);
    stream.at += count;
    return static_cast<uLong>(count);
}

uLong write_no_bytes(void*, void*, const void*, uLong) { return 0; }

ZPOS64_T tell_bytes(void*, void* file) { return static_cast<ByteStream*>(file)->at; }

long seek_bytes(void*, void* file, ZPOS64_T offset, int origin) {
    auto& stream = *static_cast<ByteStream*>(file);
    const size_t size = stream.bytes->size();
    const size_t from = origin == ZLIB_FILEFUNC_SEEK_SET   ? 0
                        : origin == ZLIB_FILEFUNC_SEEK_CUR ? stream.at
                                                           : size;
    if (offset > size - from) return -1;
    stream.at = from + static_cast<size_t>(offset);
    return 0;
}

int close_bytes(void*, void*) { return 0; }
int no_failure(void*, void*) { return 0; }

Error refused_archive(const std::string& path, ErrorCode code, std::string why) {
    return {code, {}, std::move(why), path};
}

/// At most 80 bytes of a name, without half a character of UTF-8 at its end.
std::string shown_name(const std::string& name) {
    size_t size = 80;
    if (name.size() <= size) return name;
    while (size > 0 && (static_cast<unsigned char>(name[size]) & 0xc0U) == 0x80U) --size;
    return name.substr(0, size) + "...";
}

/// An open archive.
class Unzip {
public:
    explicit Unzip(const std::string& bytes) : stream_{&bytes} {
        zlib_filefunc64_def functions{open_bytes, read_bytes,  write_no_bytes, tell_bytes,
                                      seek_bytes, close_bytes, no_failure,     &stream_};
        file_ = unzOpen2_64("", &functions);
    }
    ~Unzip() {
        if (file_) unzClose(file_);
    }
    Unzip(const Unzip&) = delete;
    Unzip& operator=(const Unzip&) = delete;

    unzFile get() const { return file_; }

private:
    ByteStream stream_;
    unzFile file_ = nullptr;
};

/// What the directory of an archive says about the file at which it is.
struct Member {
    std::string name;
    bool is_encrypted = false;
};

std::optional<Member> current_member(unzFile file) {
    unz_file_info64 info{};
    std::array<char, longest_member_name> name{};
    if (unzGetCurrentFileInfo64(file, &info, name.data(), name.size() - 1, nullptr, 0, nullptr, 0)
            != UNZ_OK
        || info.size_filename >= name.size() - 1)
        return std::nullopt;
    return Member{std::string(name.data(), info.size_filename), (info.flag & 1) != 0};
}

/// Unpacks the file at which the archive is, until its end or one byte above the limit.
std::optional<std::string> unpacked(unzFile file, size_t limit) {
    std::string text;
    std::array<char, 65536> buffer{};
    while (text.size() <= limit) {
        const int count =
            unzReadCurrentFile(file, buffer.data(), static_cast<unsigned>(buffer.size()));
        if (count < 0) return std::nullopt;
        if (count == 0) return text;
        text.append(buffer.data(), static_cast<size_t>(count));
    }
    return text;
}

} // namespace

struct ZipArchive::Contents {
    std::string path, bytes;
    std::vector<std::string> names{};
};

ZipArchive::ZipArchive(std::unique_ptr<Contents> contents) : contents_(std::move(contents)) {}
ZipArchive::ZipArchive(ZipArchive&&) noexcept = default;
ZipArchive& ZipArchive::operator=(ZipArchive&&) noexcept = default;
ZipArchive::~ZipArchive() = default;

const std::string& ZipArchive::path() const { return contents_->path; }
const std::vector<std::string>& ZipArchive::names() const { return contents_->names; }

bool ZipArchive::contains(const std::string& name) const {
    return std::find(names().begin(), names().end(), name) != names().end();
}

Result<ZipArchive> ZipArchive::open(const std::string& path) {
    using enum ErrorCode;
    if (std::string why = why_no_file(path); !why.empty())
        return tl::unexpected(refused_archive(path, io, std::move(why)));
    auto bytes = file_bytes(path, largest_archive);
    if (!bytes) return tl::unexpected(refused_archive(path, io, "cannot be read"));
    if (bytes->size() > largest_archive)
        return tl::unexpected(refused_archive(path, invalid_value, "is larger than 256 MiB"));
    auto contents = std::make_unique<Contents>(Contents{path, *std::move(bytes)});
    const Unzip zip(contents->bytes);
    if (!zip.get())
        return tl::unexpected(refused_archive(path, syntax, "is no zip archive, or is damaged"));
    int found = unzGoToFirstFile(zip.get());
    for (; found == UNZ_OK; found = unzGoToNextFile(zip.get())) {
        const auto member = current_member(zip.get());
        if (!member)
            return tl::unexpected(refused_archive(
                path, syntax, "is a damaged zip archive: its list of files ends early"));
        if (contents->names.size() == most_members)
            return tl::unexpected(
                refused_archive(path, invalid_value, "is a zip archive of more than 10,000 files"));
        contents->names.push_back(member->name);
    }
    if (found != UNZ_END_OF_LIST_OF_FILE && !contents->names.empty())
        return tl::unexpected(refused_archive(
            path, syntax, "is a damaged zip archive: its list of files ends early"));
    return ZipArchive(std::move(contents));
}

Result<std::string> ZipArchive::read(const std::string& name, size_t limit) const {
    using enum ErrorCode;
    const auto refuse = [&](ErrorCode code, std::string_view why) {
        return tl::unexpected(refused_archive(
            path(), code, fmt::format("{} in the archive {}", shown_name(name), why)));
    };
    const Unzip zip(contents_->bytes);
    if (!zip.get() || unzLocateFile(zip.get(), name.c_str(), 1) != UNZ_OK)
        return refuse(syntax, "is missing");
    const auto member = current_member(zip.get());
    if (!member) return refuse(syntax, "is damaged");
    if (member->is_encrypted)
        return refuse(unsupported, "is encrypted: save it without a password");
    if (unzOpenCurrentFile(zip.get()) != UNZ_OK)
        return refuse(unsupported, "is damaged or packed in a way that is not supported");
    auto text = unpacked(zip.get(), limit);
    const bool is_whole = unzCloseCurrentFile(zip.get()) == UNZ_OK;
    if (text && text->size() > limit)
        return refuse(invalid_value, fmt::format("is larger than {} MiB", limit >> 20));
    if (!text || !is_whole) return refuse(syntax, "is damaged");
    return *std::move(text);
}

} // namespace core
