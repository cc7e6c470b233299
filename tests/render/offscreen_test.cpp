#include <cstdlib>
#include <filesystem>

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_NO_LINEAR
#define STBI_NO_HDR
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wshadow"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

#include "render/offscreen.h"
#include "render/renderer.h"
#include "tests/render/sample_scene.h"
#include "tests/support/scoped_folder.h"

namespace render {
namespace {

const Viewport size{480, 300};

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

/// The difference of two pictures.
struct ImageDifference {
    bool same_size = false;
    double mean = 0.0;      // of all channels, 0..255
    double different = 0.0; // fraction of pixels with a channel beyond the tolerance
};

ImageDifference difference(const Image& a, const Image& b, int tolerance = 12) {
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

/// A context and a renderer for all tests of this file.
class Picture : public testing::Test {
protected:
    static void SetUpTestSuite() {
        auto made = Offscreen::make();
        ASSERT_TRUE(made) << made.error().message;
        context = std::make_unique<Offscreen>(std::move(*made));
        auto drawer = Renderer::make();
        ASSERT_TRUE(drawer) << drawer.error().message;
        renderer = std::make_unique<Renderer>(std::move(*drawer));
        scene = std::make_unique<Scene>(sample_scene());
    }
    static void TearDownTestSuite() {
        renderer.reset();
        context.reset();
        scene.reset();
    }

    static Image drawn(const Scene& what, const Camera& camera, const DrawOptions& options = {}) {
        auto canvas = Canvas::make(size);
        EXPECT_TRUE(canvas) << canvas.error().message;
        renderer->draw(what, camera, options, *canvas);
        EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
        return canvas->pixels();
    }

    /// Compares with the picture of that name; what was drawn stays in the temporary folder.
    static void expect_golden(const std::string& name, const Scene& what, const Camera& camera,
                              const DrawOptions& options = {}) {
        const auto image = still_picture(*renderer, what, camera, options, size);
        ASSERT_TRUE(image) << image.error().message;
        EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
        const std::filesystem::path path =
            std::filesystem::path(FEELER_SOURCE_DIR) / "tests/golden/render" / (name + ".png");
        const std::filesystem::path drawn_path =
            std::filesystem::path(testing::TempDir()) / ("feeler-" + name + ".png");
        ASSERT_TRUE(write_png(*image, drawn_path));
        const auto expected = read_png(path);
        ASSERT_TRUE(expected) << expected.error().message << "; drawn: " << drawn_path;
        const ImageDifference found = difference(*image, *expected, 24);
        EXPECT_TRUE(found.same_size);
        EXPECT_LT(found.mean, 1.0) << "drawn: " << drawn_path;
        EXPECT_LT(found.different, 0.01) << "drawn: " << drawn_path;
    }

    static Camera work_camera() {
        Camera camera;
        camera.yaw = -0.55;
        camera.pitch = 0.5;
        camera = framing(camera, size, work_bounds(*scene));
        camera.target = {0, -5, 0};
        camera.distance *= 0.62;
        return camera;
    }

    static std::unique_ptr<Offscreen> context;
    static std::unique_ptr<Renderer> renderer;
    static std::unique_ptr<Scene> scene;
};

std::unique_ptr<Offscreen> Picture::context;
std::unique_ptr<Renderer> Picture::renderer;
std::unique_ptr<Scene> Picture::scene;

/// Pixels whose colour is nearly this one.
size_t count_near(const Image& image, Color wanted, int tolerance) {
    size_t count = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const uint8_t* p = image.pixel(x, y);
            count += std::abs(p[0] - wanted.r) <= tolerance
                     && std::abs(p[1] - wanted.g) <= tolerance
                     && std::abs(p[2] - wanted.b) <= tolerance;
        }
    return count;
}

TEST_F(Picture, ShowsTheWholeSetupInTheDark) { expect_golden("setup-dark", *scene, work_camera()); }

TEST_F(Picture, ShowsTheWholeSetupInTheLight) {
    expect_golden("setup-light", *scene, work_camera(), {.theme = ColorScheme::light});
}

TEST_F(Picture, ShowsTheFacesOfASection) {
    Scene cut = *scene;
    cut.section = SectionPlane{{0, -1, 0}, 4.0};
    cut.path_visible = false;
    Camera camera = work_camera();
    camera.yaw = -1.1;
    expect_golden("section", cut, camera);
}

TEST_F(Picture, ShowsTheWitnessThroughWhatHidesIt) {
    Camera camera = work_camera();
    camera.yaw = 0.5;
    camera.pitch = 0.1; // the clamp is in front
    camera.distance = 200.0;
    expect_golden("witness", *scene, camera);
    Scene without = *scene;
    without.witness.reset();
    without.path_visible = false;
    Scene with = without;
    with.witness = scene->witness;
    const Color ink = color(ColorScheme::dark, Role::violation);
    EXPECT_EQ(count_near(drawn(without, camera), ink, 24), 0u);
    EXPECT_GT(count_near(drawn(with, camera), ink, 24), 20u);
}

TEST_F(Picture, HasTheBackgroundOfThePaletteAndNothingSeenThrough) {
    const Image image = drawn(Scene(), Camera());
    const Color top = color(ColorScheme::dark, Role::view_top);
    EXPECT_NEAR(image.pixel(200, 0)[0], top.r, 2);
    EXPECT_NEAR(image.pixel(200, 0)[2], top.b, 2);
    const Color bottom = color(ColorScheme::dark, Role::view_bottom);
    EXPECT_NEAR(image.pixel(200, size.height - 1)[1], bottom.g, 2);
    const Image full = drawn(*scene, work_camera());
    for (size_t i = 3; i < full.rgba.size(); i += 4) ASSERT_EQ(full.rgba[i], 255);
}

TEST_F(Picture, IsTheSameWhenDrawnAgain) {
    const Image first = drawn(*scene, work_camera());
    drawn(Scene(), Camera());
    EXPECT_EQ(drawn(*scene, work_camera()).rgba, first.rgba);
}

TEST_F(Picture, MakesTheCurrentBlockBright) {
    Scene plain;
    plain.path = scene->path;
    plain.fade_later_blocks = false;
    Camera camera = framing(Camera(), size, scene->path->bounds);
    const size_t before = count_near(drawn(plain, camera), {255, 255, 255}, 40);
    plain.current_block = 2;
    EXPECT_GT(count_near(drawn(plain, camera), {255, 255, 255}, 40), before + 30);
}

TEST_F(Picture, FadesWhatComesLater) {
    Scene plain;
    plain.path = scene->path;
    const Camera camera = framing(Camera(), size, scene->path->bounds);
    const Color amber = color(ColorScheme::dark, Role::near);
    plain.current_block = 0;
    const size_t faded = count_near(drawn(plain, camera), amber, 30);
    plain.current_block.reset();
    EXPECT_GT(count_near(drawn(plain, camera), amber, 30), faded + 100);
}

TEST_F(Picture, DrawsArrowsOfTheSameSizeAtEveryZoom) {
    Scene plain;
    plain.triads = {{.name = "G54", .origin = {10, 20, 30}}};
    Camera camera;
    camera.target = {10, 20, 30};
    std::vector<size_t> counts;
    for (const double distance : {20.0, 200.0, 2000.0}) {
        camera.distance = distance;
        counts.push_back(
            count_near(drawn(plain, camera), color(ColorScheme::dark, Role::axis_z), 60));
    }
    EXPECT_GT(counts[0], 80u);
    for (const size_t count : counts)
        EXPECT_NEAR(static_cast<double>(count), static_cast<double>(counts[0]), 30.0);
}

TEST_F(Picture, DrawsTheGroundWithAShadowSeenFromAbove) {
    Scene plain;
    plain.bodies = {scene->bodies[0]};
    const core::Aabb box = bounds(plain.bodies[0]);
    Camera camera = framing(Camera(), size, box);
    // How much darker the ground is along the foot of the body.
    const auto darker = [&](double pitch) {
        camera.pitch = pitch;
        plain.ground.reset();
        const Image without = drawn(plain, camera, {.theme = ColorScheme::light});
        plain.ground = Ground{core::translation({0, 0, box.min.z})};
        const Image with = drawn(plain, camera, {.theme = ColorScheme::light});
        double sum = 0.0;
        for (int i = 0; i < 100; ++i) {
            const auto at =
                project(camera, size, {box.min.x + 5.0 + i, box.min.y - 2.0, box.min.z});
            const int x = static_cast<int>(at->position.x), y = static_cast<int>(at->position.y);
            sum += without.pixel(x, y)[0] - with.pixel(x, y)[0];
        }
        return sum / 100.0;
    };
    EXPECT_GT(darker(0.7), 30.0);
    EXPECT_LT(darker(-0.7), 20.0); // from below there are only lines
}

TEST_F(Picture, DrawsIntendedContactCalmly) {
    Scene plain;
    plain.witness = Witness{{0, 0, 0}, {0, 0, 0}, ClearanceState::clear, false, true};
    Camera camera;
    camera.distance = 100.0;
    const Image image = drawn(plain, camera);
    EXPECT_GT(difference(image, drawn(Scene(), camera)).different, 0.0);
    EXPECT_LT(difference(image, drawn(Scene(), camera)).different, 0.001);
    EXPECT_EQ(count_near(image, color(ColorScheme::dark, Role::violation), 60), 0u);
}

TEST_F(Picture, DrawsTheDepthOfAnOverlapAsALineOfThatLength) {
    Scene plain;
    plain.witness = Witness{{0, 0, -10}, {0, 0, 10}, ClearanceState::violation, true};
    Camera camera = seen_from(Camera(), StandardView::front);
    camera.distance = 60.0;
    camera.projection = Projection::orthographic;
    const Image image = drawn(plain, camera);
    const Color ink = color(ColorScheme::dark, Role::violation);
    int top = size.height, bottom = 0;
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
            if (std::abs(image.pixel(x, y)[0] - ink.r) < 40 && image.pixel(x, y)[2] < 90) {
                top = std::min(top, y);
                bottom = std::max(bottom, y);
            }
    const double expected = project(camera, size, {0, 0, -10})->position.y
                            - project(camera, size, {0, 0, 10})->position.y;
    EXPECT_NEAR(bottom - top, expected, 6.0);
    plain.witness->b = plain.witness->a; // of no length: still there
    EXPECT_GT(count_near(drawn(plain, camera), ink, 60), 20u);
}

TEST_F(Picture, DrawsAPathOfManyPieces) {
    // More than one texture holds; the last piece is as much there as the first.
    std::vector<PathPoint> points;
    for (uint32_t i = 0; i < 150'000; ++i)
        points.push_back({.position = {static_cast<float>(i) * 1e-3F, 0, 0},
                          .block = i,
                          .state = ClearanceState::violation});
    Scene plain;
    plain.path = std::make_shared<const ToolPath>(tool_path(points));
    Camera camera = seen_from(Camera(), StandardView::top);
    camera.target = {75, 0, 0};
    camera.distance = 400;
    const Image image = drawn(plain, camera);
    const Color ink = color(ColorScheme::dark, Role::violation);
    for (const double x : {1.0, 70.0, 100.0, 149.0}) {
        const Vec2 at = project(camera, size, {x, 0, 0})->position;
        const uint8_t* p = image.pixel(static_cast<int>(at.x), static_cast<int>(at.y));
        EXPECT_NEAR(p[0], ink.r, 30) << x;
    }
}

TEST_F(Picture, IsSmootherWithSamples) {
    auto canvas = Canvas::make(size, 4);
    ASSERT_TRUE(canvas);
    EXPECT_EQ(canvas->samples(), 4);
    renderer->draw(*scene, work_camera(), {}, *canvas);
    const ImageDifference found = difference(canvas->pixels(), drawn(*scene, work_camera()));
    EXPECT_GT(found.different, 0.002);
    EXPECT_LT(found.mean, 3.0);
}

TEST(PictureFile, IsReadAsItWasWritten) {
    const test_support::ScopedFolder folder;
    Image image{3, 2, {}};
    for (uint8_t i = 0; i < 24; ++i) image.rgba.push_back(static_cast<uint8_t>(10 * i));
    const std::filesystem::path path = folder.write("a.png", "");
    ASSERT_TRUE(write_png(image, path));
    EXPECT_EQ(read_png(path)->rgba, image.rgba);
    EXPECT_FALSE(read_png(path.parent_path() / "none.png"));
    EXPECT_FALSE(write_png(image, path.parent_path() / "no" / "folder.png"));
}

TEST(ImageDifference, CountsPixelsBeyondTheTolerance) {
    Image a{2, 2, std::vector<uint8_t>(16, 100)}, b = a;
    EXPECT_EQ(difference(a, b).different, 0.0);
    b.rgba[5] = 120;
    b.rgba[9] = 105;
    EXPECT_EQ(difference(a, b, 12).different, 0.25);
    EXPECT_NEAR(difference(a, b, 12).mean, 25.0 / 16.0, 1e-12);
    b.width = 1;
    EXPECT_FALSE(difference(a, b).same_size);
}

TEST(Image, HalvesByTheMean) {
    const Image whole{2, 2, {0, 0, 0, 255, 100, 0, 0, 255, 0, 40, 0, 255, 0, 0, 4, 255}};
    const Image half = halved(whole);
    EXPECT_EQ(half.rgba, (std::vector<uint8_t>{25, 10, 1, 255}));
}

} // namespace
} // namespace render
