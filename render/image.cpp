#include "render/image.h"

#include <fmt/format.h>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wshadow"
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

} // namespace render
