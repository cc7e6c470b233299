#include "render/image.h"

#include <fstream>

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

namespace {

/// Takes the bytes of a picture for a std::string.
void append(void* text, void* data, int size) {
    static_cast<std::string*>(text)->append(static_cast<const char*>(data),
                                            static_cast<size_t>(size));
}

} // namespace

core::Result<void> write_png(const Image& image, const std::filesystem::path& path) {
    std::string bytes;
    const bool is_made = stbi_write_png_to_func(append, &bytes, image.width, image.height, 4,
                                                image.rgba.data(), 4 * image.width)
                         != 0;
    std::ofstream file(path, std::ios::binary);
    file << bytes;
    file.close();
    if (!is_made || file.fail())
        return core::fail(core::ErrorCode::io,
                          fmt::format("cannot write the picture '{}'", path.generic_string()));
    return {};
}

std::string jpeg_bytes(const Image& image, int quality) {
    std::string bytes;
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
