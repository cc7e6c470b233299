#include "render/image.h"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_NO_LINEAR
#define STBI_NO_HDR
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wshadow"
#include <stb/stb_image.h>
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace render {

core::Result<void> write_png(const Image& image, const std::filesystem::path& path) {
    if (stbi_write_png(path.c_str(), image.width, image.height, 4, image.rgba.data(),
                       4 * image.width)
        == 0)
        return core::fail(core::ErrorCode::io,
                          fmt::format("cannot write the picture '{}'", path.string()));
    return {};
}

std::string jpeg_bytes(const Image& image, int quality) {
    std::string bytes;
    const auto append = [](void* text, void* data, int size) {
        static_cast<std::string*>(text)->append(static_cast<const char*>(data),
                                                static_cast<size_t>(size));
    };
    stbi_write_jpg_to_func(append, &bytes, image.width, image.height, 4, image.rgba.data(),
                           quality);
    return bytes;
}

core::Result<Image> read_png(const std::filesystem::path& path) {
    Image image;
    int channels = 0;
    uint8_t* bytes = stbi_load(path.c_str(), &image.width, &image.height, &channels, 4);
    if (bytes == nullptr)
        return core::fail(core::ErrorCode::io, fmt::format("cannot read the picture '{}': {}",
                                                           path.string(), stbi_failure_reason()));
    image.rgba.assign(
        bytes, bytes + 4 * static_cast<size_t>(image.width) * static_cast<size_t>(image.height));
    stbi_image_free(bytes);
    return image;
}

Image halved(const Image& image) {
    Image half{image.width / 2, image.height / 2, {}};
    half.rgba.resize(4 * static_cast<size_t>(half.width) * static_cast<size_t>(half.height));
    size_t next = 0;
    for (int y = 0; y < half.height; ++y)
        for (int x = 0; x < half.width; ++x)
            for (size_t c = 0; c < 4; ++c) {
                const int sum = image.pixel(2 * x, 2 * y)[c] + image.pixel(2 * x + 1, 2 * y)[c]
                                + image.pixel(2 * x, 2 * y + 1)[c]
                                + image.pixel(2 * x + 1, 2 * y + 1)[c];
                half.rgba[next++] = static_cast<uint8_t>((sum + 2) / 4);
            }
    return half;
}

ImageDifference difference(const Image& a, const Image& b, int tolerance) {
    ImageDifference found;
    found.same_size = a.width == b.width && a.height == b.height;
    if (!found.same_size || a.rgba.empty()) return found;
    size_t different = 0;
    double sum = 0.0;
    for (size_t i = 0; i < a.rgba.size(); i += 4) {
        int most = 0;
        for (size_t c = 0; c < 4; ++c) {
            const int apart = std::abs(a.rgba[i + c] - b.rgba[i + c]);
            most = std::max(most, apart);
            sum += apart;
        }
        different += most > tolerance ? 1 : 0;
    }
    found.mean = sum / static_cast<double>(a.rgba.size());
    found.different = static_cast<double>(different) / (static_cast<double>(a.rgba.size()) / 4.0);
    return found;
}

} // namespace render
