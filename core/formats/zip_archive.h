#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace core {

/// A zip archive in memory. Nothing is ever unpacked to the disk, so the names in it cannot lead
/// anywhere.
class ZipArchive {
public:
    /// Errors: io if the file cannot be read; syntax if it is no zip archive; invalid_value if it
    /// is
    ///         larger than 256 MiB or has more than 10,000 files.
    static Result<ZipArchive> open(const std::string& path);

    ZipArchive(ZipArchive&&) noexcept;
    ZipArchive& operator=(ZipArchive&&) noexcept;
    ~ZipArchive();

    const std::string& path() const;

    /// The names of its files, in their order.
    const std::vector<std::string>& names() const;
    bool contains(const std::string& name) const;

    /// The bytes of a file. At most `limit` bytes are unpacked, whatever the archive claims.
    ///
    /// Errors: syntax if there is no such file, or it is damaged; unsupported if it is encrypted or
    ///         packed in an unknown way; invalid_value if it is larger than `limit`.
    Result<std::string> read(const std::string& name, size_t limit) const;

private:
    struct Contents;
    explicit ZipArchive(std::unique_ptr<Contents> contents);

    std::unique_ptr<Contents> contents_;
};

/// The largest file that the readers of archives unpack, bytes.
constexpr size_t largest_member = size_t(64) << 20;

} // namespace core
