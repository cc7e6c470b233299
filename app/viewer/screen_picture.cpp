#include "app/viewer/screen_picture.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

namespace app::viewer {

render::Image screen_picture(int width, int height) {
    render::Image image{width, height, {}};
    const size_t row = 4 * static_cast<size_t>(width);
    std::vector<uint8_t> pixels(row * static_cast<size_t>(height));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    for (size_t y = static_cast<size_t>(height); y-- > 0;)
        image.rgba.insert(image.rgba.end(), pixels.begin() + static_cast<ptrdiff_t>(y * row),
                          pixels.begin() + static_cast<ptrdiff_t>((y + 1) * row));
    for (size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
    return image;
}

std::filesystem::path free_picture_name(const std::filesystem::path& folder) {
    std::filesystem::path path;
    for (int number = 1; number < 10000; ++number) {
        path = folder / fmt::format("feeler-{:04}.png", number);
        std::error_code ignored;
        if (!std::filesystem::exists(path, ignored)) break;
    }
    return path;
}

} // namespace app::viewer
