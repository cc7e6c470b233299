#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace render {

/// An RGBA picture, rows from the top.
struct Image {
    int width = 0, height = 0;
    std::vector<uint8_t> rgba;

    const uint8_t* pixel(int x, int y) const {
        return &rgba[4
                     * (static_cast<size_t>(y) * static_cast<size_t>(width)
                        + static_cast<size_t>(x))];
    }
};

core::Result<void> write_png(const Image& image, const std::filesystem::path& path);
/// The bytes of a JPEG file. `quality`: 1 to 100. Transparency is ignored.
std::string jpeg_bytes(const Image& image, int quality);

/// Half the size, each pixel the mean of four: used for anti-aliasing.
Image halved(const Image& image);

} // namespace render
