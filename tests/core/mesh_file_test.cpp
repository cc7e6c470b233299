#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geom/mesh_file.h"
#include "tests/support/meshes.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/stl_writer.h"

namespace core {
namespace {

using test_support::ascii_stl;
using test_support::binary_stl;
using test_support::box_mesh;
using test_support::together;
using test_support::torus_mesh;
using ::testing::HasSubstr;

/// A file that is deleted after the test.
class TemporaryFile {
public:
    TemporaryFile(const std::string& name, const std::string& bytes)
        : path_(folder_.write(
            ::testing::UnitTest::GetInstance()->current_test_info()->name() + name, bytes)) {}
    const std::filesystem::path& path() const { return path_; }

private:
    const test_support::ScopedFolder folder_;
    const std::filesystem::path path_;
};

Result<MeshFile> read(const std::string& name, const std::string& bytes) {
    return read_mesh(TemporaryFile(name, bytes).path());
}

std::string error_of(const std::string& name, const std::string& bytes) {
    const auto result = read(name, bytes);
    if (result) return "it was read";
    EXPECT_THAT(result.error().message, HasSubstr(name)); // every error names its file
    EXPECT_FALSE(result.error().file.empty());
    return result.error().message;
}

std::string with(std::string text, const std::string& what, const std::string& instead) {
    const size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), instead);
}

const Mesh cube = box_mesh(Vec3(0.0), Vec3(10.0));

const std::string cube_obj = R"(# a cube, quadrilaterals
mtllib /dev/zero
v 0 0 0
v 10 0 0
v 10 10 0
v 0 10 0
v 0 0 10 0.5 0.5 0.5
v 10 0 1e1
v +10 10 10
v 0 10 10
usemtl steel
f 4/1/1 3/2/1 2//1 1
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f -6 -5 -1 -2
f 4 1 5 8
)";

const std::string cube_off = R"(OFF
# a cube, with colours
8 6 12
0 0 0
10 0 0
10 10 0
0 10 0

0 0 10
10 0 10
10 10 10
0 10 10
4 3 2 1 0 255 0 0
4 4 5 6 7 0.5 0.5 0.5 1.0
4 0 1 5 4
4 1 2 6 5
4 2 3 7 6
4 3 0 4 7
)";

const std::string cube_ply = R"(ply
format ascii 1.0
comment a cube
element vertex 8
property float x
property float y
property float z
property uchar red
element face 6
property list uchar int vertex_indices
end_header
0 0 0 1
10 0 0 1
10 10 0 1
0 10 0 1
0 0 10 1
10 0 10 1
10 10 10 1
0 10 10 1
4 3 2 1 0
4 4 5 6 7
4 0 1 5 4
4 1 2 6 5
4 2 3 7 6
4 3 0 4 7
)";

std::string binary_ply(bool big_endian) {
    std::string bytes = with(cube_ply.substr(0, cube_ply.find("0 0 0 1")), "ascii",
                             big_endian ? "binary_big_endian" : "binary_little_endian");
    const auto put = [&](const auto& value) {
        std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
        if (big_endian) std::reverse(raw.begin(), raw.end());
        bytes += raw;
    };
    for (int i = 0; i < 8; ++i) {
        put(i % 4 == 1 || i % 4 == 2 ? 10.0F : 0.0F);
        put(i % 4 >= 2 ? 10.0F : 0.0F);
        put(i >= 4 ? 10.0F : 0.0F);
        put(uint8_t{1});
    }
    const int faces[6][4] = {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4},
                             {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    for (const auto& face : faces) {
        put(uint8_t{4});
        for (const int corner : face) put(int32_t{corner});
    }
    return bytes;
}

void expect_cube(const Result<MeshFile>& file) {
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->mesh.vertices.size(), 8u);
    EXPECT_EQ(file->mesh.triangles.size(), 12u);
    EXPECT_EQ(signed_volume(file->mesh), 1000.0);
    EXPECT_EQ(file->mesh.bounds().min, Vec3(0.0));
    EXPECT_THAT(file->repairs, ::testing::IsEmpty());
}

TEST(MeshFile, ReadsACubeFromEveryFormat) {
    expect_cube(read("cube.stl", binary_stl(cube)));
    expect_cube(read("cube.STL", ascii_stl(cube)));
    expect_cube(read("cube.obj", cube_obj));
    expect_cube(read("cube.off", cube_off));
    expect_cube(read("cube.ply", cube_ply));
    expect_cube(read("little.ply", binary_ply(false)));
    expect_cube(read("big.ply", binary_ply(true)));
}

TEST(MeshFile, ReadsAPlyWithMoreToItThanASurface) {
    // OpenMesh takes a list that it does not know for a single word.
    std::string text = with(cube_ply, "property uchar red", "property list uchar float weights");
    for (size_t at = 0; (at = text.find(" 1\n", at)) != std::string::npos; at += 5)
        text.replace(at, 3, " 2 7 9\n");
    text = with(text, "element face 6", "element edge 1\nproperty int a\nelement face 6");
    text = with(text, "4 3 2 1 0", "5\n4 3 2 1 0");
    expect_cube(read("cube.ply", text));
}

TEST(MeshFile, ReadsABinaryStlThatBeginsWithSolid) {
    expect_cube(read("cube.stl", binary_stl(cube, "solid made by a careless program")));
}

TEST(MeshFile, ReadsAnAsciiStlWhoseNameLooksLikeAKeyword) {
    expect_cube(read("cube.stl", ascii_stl(cube, "outer loop facet normal ring")));
}

TEST(MeshFile, ReadsTwoSolidsOfOneAsciiStl) {
    const Mesh other = box_mesh(Vec3(20.0), Vec3(30.0));
    const auto file = read("two.stl", ascii_stl(cube) + ascii_stl(other));
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(signed_volume(file->mesh), 2000.0);
}

TEST(MeshFile, ReadsAnOffWithItsCountsOnTheHeaderLine) {
    expect_cube(read("cube.off", with(cube_off, "OFF\n# a cube, with colours\n", "OFF ")));
}

TEST(MeshFile, KeepsBothCubesThatShareAnEdge) {
    const Mesh both = together(cube, box_mesh(Vec3(10.0, 10.0, 0.0), Vec3(20.0, 20.0, 10.0)));
    const auto file = read("two.stl", binary_stl(both));
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->mesh.triangles.size(), 24u);
    EXPECT_EQ(file->mesh.vertices.size(), 14u);
    EXPECT_EQ(signed_volume(file->mesh), 2000.0);
}

TEST(MeshFile, SaysWhenThereIsNoSuchFile) {
    EXPECT_THAT(read_mesh("/nowhere/part.stl").error().message, HasSubstr("no such file"));
    EXPECT_THAT(read_mesh(::testing::TempDir()).error().message, HasSubstr("folder"));
    EXPECT_THAT(read_mesh("/dev/null").error().message, HasSubstr("not a file"));
    EXPECT_THAT(error_of("empty.stl", ""), HasSubstr("empty"));
}

TEST(MeshFile, RefusesAnUnknownExtension) {
    EXPECT_THAT(error_of("part.step", "ISO-10303-21;"),
                HasSubstr("'.step' is not the ending of a mesh"));
    EXPECT_THAT(error_of("part", "solid"), HasSubstr("is not the ending of a mesh"));
}

TEST(MeshFile, RefusesATruncatedStl) {
    const std::string whole = binary_stl(cube);
    for (const size_t length : {1u, 83u, 84u, 85u, 133u, 683u})
        EXPECT_THAT(error_of("cut.stl", whole.substr(0, length)), HasSubstr("84")) << length;
    EXPECT_THAT(error_of("long.stl", whole + "x"), HasSubstr("12 triangles, which take 684"));
}

TEST(MeshFile, RefusesAMiscountedStl) {
    std::string bytes = binary_stl(cube);
    bytes[80] = 11;
    EXPECT_THAT(error_of("count.stl", bytes), HasSubstr("11 triangles"));
    bytes[83] = '\x7f';
    EXPECT_THAT(error_of("count.stl", bytes), HasSubstr("triangles, which take"));
    EXPECT_THAT(error_of("none.stl", binary_stl(Mesh{})), HasSubstr("no triangles"));
}

TEST(MeshFile, RefusesCoordinatesOfABinaryStlThatAreNotFinite) {
    for (const float bad : {std::nanf(""), INFINITY, -INFINITY}) {
        std::string bytes = binary_stl(cube);
        std::memcpy(bytes.data() + 84 + 3 * 50 + 12 + 8, &bad, 4);
        EXPECT_THAT(error_of("nan.stl", bytes), HasSubstr("triangle 4 has a coordinate"));
    }
}

TEST(MeshFile, RefusesAnAsciiStlThatIsNotInOrder) {
    const std::string whole = ascii_stl(cube);
    const std::string number = "10.000000";
    for (const char* bad : {"nan", "inf", "-inf", "1e400", "ten", "1.0.0", "0x10"})
        EXPECT_THAT(error_of("bad.stl", with(whole, number, bad)),
                    HasSubstr(std::string("'").append(bad).append("' is not a coordinate")));
    EXPECT_THAT(error_of("bad.stl", with(whole, number, "nan")), HasSubstr("line 5:"));
    EXPECT_THAT(error_of("end.stl", with(whole, "endsolid test\n", "")),
                HasSubstr("without 'endsolid'"));
    EXPECT_THAT(error_of("cut.stl", whole.substr(0, whole.find("endloop"))),
                HasSubstr("the file ends in triangle 1, before 'endloop'"));
    EXPECT_THAT(error_of("none.stl", "solid nothing\nendsolid nothing\n"),
                HasSubstr("no triangles"));
    EXPECT_THAT(error_of("quad.stl", with(whole, " endloop", "vertex 1 2 3\n endloop")),
                HasSubstr("found 'vertex' where 'endloop'"));
    EXPECT_THAT(error_of("noise.stl", "just some text"), HasSubstr("84 bytes"));
}

TEST(MeshFile, RefusesAnObjThatIsNotInOrder) {
    EXPECT_THAT(error_of("o.obj", with(cube_obj, "f 5 6 7 8", "f 5 6 7 9")),
                HasSubstr("line 13: a face refers to vertex 9, but there are 8"));
    EXPECT_THAT(error_of("o.obj", with(cube_obj, "f 5 6 7 8", "f 5 6 7 0")),
                HasSubstr("refers to vertex 0"));
    EXPECT_THAT(error_of("o.obj", with(cube_obj, "f 5 6 7 8", "f 5 6 7 -9")),
                HasSubstr("refers to vertex -9"));
    EXPECT_THAT(error_of("o.obj", with(cube_obj, "f 5 6 7 8", "f 5 6")), HasSubstr("2 corners"));
    EXPECT_THAT(error_of("o.obj", with(cube_obj, "f 5 6 7 8", "f 5 6 7 x")), HasSubstr("'x'"));
    EXPECT_THAT(error_of("o.obj", with(cube_obj, "v 10 0 0", "v 10 0")),
                HasSubstr("line 4: a vertex has 2 coordinates"));
    EXPECT_THAT(error_of("o.obj", with(cube_obj, "v 10 0 0", "v 10 nan 0")), HasSubstr("'nan'"));
    EXPECT_THAT(error_of("o.obj", "v 0 0 0\n"), HasSubstr("no faces"));
}

TEST(MeshFile, RefusesAnOffThatIsNotInOrder) {
    EXPECT_THAT(error_of("o.off", with(cube_off, "4 0 1 5 4", "4 0 1 5 8")),
                HasSubstr("refers to vertex 8, but there are 8, counted from 0"));
    EXPECT_THAT(error_of("o.off", with(cube_off, "4 0 1 5 4", "4 0 1 -5 4")), HasSubstr("-5"));
    EXPECT_THAT(error_of("o.off", with(cube_off, "4 0 1 5 4", "4 0 1 5")),
                HasSubstr("lists only 3"));
    EXPECT_THAT(error_of("o.off", with(cube_off, "8 6 12", "8 7 12")),
                HasSubstr("ends after 6 of 7 faces"));
    EXPECT_THAT(error_of("o.off", with(cube_off, "8 6 12", "9 6 12")), HasSubstr("o.off"));
    EXPECT_THAT(error_of("o.off", with(cube_off, "8 6 12", "8 x")), HasSubstr("counts"));
    EXPECT_THAT(error_of("o.off", with(cube_off, "10 10 0", "10 inf 0")), HasSubstr("'inf'"));
    EXPECT_THAT(error_of("o.off", "FOO\n"), HasSubstr("'FOO'"));
}

TEST(MeshFile, RefusesAPlyThatIsNotInOrder) {
    EXPECT_THAT(error_of("p.ply", with(cube_ply, "4 0 1 5 4", "4 0 1 5 8")),
                HasSubstr("face 3 refers to vertex 8"));
    EXPECT_THAT(error_of("p.ply", with(cube_ply, "4 0 1 5 4", "2 0 1")), HasSubstr("2 corners"));
    EXPECT_THAT(error_of("p.ply", with(cube_ply, "10 10 0 1", "10 nan 0 1")),
                HasSubstr("vertex 3"));
    EXPECT_THAT(error_of("p.ply", with(cube_ply, "face 6", "face 7")), HasSubstr("face 7"));
    EXPECT_THAT(error_of("p.ply", with(cube_ply, "face 6", "face 4000000000")),
                HasSubstr("line 9: this part of the header"));
    EXPECT_THAT(error_of("p.ply", with(cube_ply, "ply", "plx")), HasSubstr("'ply'"));
    EXPECT_THAT(error_of("p.ply", with(cube_ply, "end_header", "")), HasSubstr("header"));
    EXPECT_THAT(error_of("p.ply", with(cube_ply, "property float z\n", "")), HasSubstr("p.ply"));
    const std::string whole = binary_ply(false);
    EXPECT_THAT(error_of("p.ply", whole.substr(0, whole.size() - 1)), HasSubstr("face 6"));
    const size_t body = whole.find("end_header\n") + 11;
    EXPECT_THAT(error_of("p.ply", whole.substr(0, body + 20)), HasSubstr("vertex 2 is missing"));
}

TEST(MeshFile, SurvivesFilesWithDamage) {
    const std::pair<const char*, std::string> files[] = {
        {"d.stl", binary_stl(cube)}, {"a.stl", ascii_stl(cube)}, {"d.obj", cube_obj},
        {"d.off", cube_off},         {"d.ply", cube_ply},        {"b.ply", binary_ply(false)}};
    std::mt19937 rng(2024);
    size_t read_count = 0, refused_count = 0;
    for (const auto& [name, whole] : files)
        for (int round = 0; round < 300; ++round) {
            std::string bytes = whole;
            for (int k = 0; k <= round % 4; ++k) {
                const size_t at = rng() % bytes.size();
                const char* const marks = "0123456789-.e \n/#";
                switch (rng() % 4) {
                case 0:
                    bytes[at] = static_cast<char>(rng());
                    break;
                case 1:
                    bytes[at] = marks[rng() % 17];
                    break;
                case 2:
                    bytes.erase(at, 1 + rng() % 3);
                    break;
                default:
                    bytes.insert(at, 1, marks[rng() % 17]);
                    break;
                }
            }
            const auto file = read(name, bytes);
            ++(file ? read_count : refused_count);
            if (!file) continue;
            std::vector<std::string> repairs;
            EXPECT_TRUE(checked_solid(file->mesh, repairs));
            EXPECT_TRUE(repairs.empty()); // the result needs no further repair
            EXPECT_GT(signed_volume(file->mesh), 0.0);
        }
    EXPECT_GT(read_count, 100u);
    EXPECT_GT(refused_count, 600u);
}

TEST(MeshFile, SaysThatDegenerateTrianglesAreLeftOut) {
    Mesh mesh = cube;
    mesh.triangles.push_back({3, 3, 5});
    for (const std::string& bytes : {binary_stl(mesh), ascii_stl(mesh)}) {
        const auto file = read("flat.stl", bytes);
        ASSERT_TRUE(file) << file.error().message;
        ASSERT_EQ(file->repairs.size(), 1u);
        EXPECT_EQ(file->repairs[0], "1 triangles with two equal corners were removed");
        EXPECT_EQ(file->mesh.triangles.size(), 12u);
    }
}

TEST(MeshFile, CutsAFaceWithADentAlongItsCorners) {
    // An L-shaped prism whose two ends are hexagons; the area of the mesh reveals wrong cuts.
    const std::string obj = R"(v 0 0 0
v 4 0 0
v 4 1 0
v 1 1 0
v 1 4 0
v 0 4 0
v 0 0 1
v 4 0 1
v 4 1 1
v 1 1 1
v 1 4 1
v 0 4 1
f 6 5 4 3 2 1
f 7 8 9 10 11 12
f 1 2 8 7
f 2 3 9 8
f 3 4 10 9
f 4 5 11 10
f 5 6 12 11
f 6 1 7 12
)";
    const auto file = read("l.obj", obj);
    ASSERT_TRUE(file) << file.error().message;
    double area = 0.0;
    for (size_t i = 0; i < file->mesh.triangles.size(); ++i) {
        const Triangle t = file->mesh.triangle(i);
        area += 0.5 * glm::length(glm::cross(t.b - t.a, t.c - t.a));
    }
    EXPECT_NEAR(area, 2.0 * 7.0 + 16.0, 1e-12);
    EXPECT_NEAR(signed_volume(file->mesh), 7.0, 1e-12);
}

} // namespace
} // namespace core
