#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace render {

/// A picture: RGBA, rows from the top.
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
/// The bytes of a JPEG file. `quality`: 1 to 100. What is seen through shows as if it covered.
std::string jpeg_bytes(const Image& image, int quality);

core::Result<Image> read_png(const std::filesystem::path& path);

/// Half as large both ways, each pixel the mean of four: how pictures with smooth edges are made.
Image halved(const Image& image);

/// How two pictures differ.
struct ImageDifference {
    bool same_size = false;
    double mean = 0.0;      // of all channels, 0..255
    double different = 0.0; // share of pixels with a channel farther apart than the tolerance
};

ImageDifference difference(const Image& a, const Image& b, int tolerance = 12);

} // namespace render
