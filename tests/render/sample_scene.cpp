#include "tests/render/sample_scene.h"

#include <cmath>
#include <numbers>

#include "core/geom/mesh.h"
#include "render/body_mesh.h"
#include "render/setup_scene.h"
#include "render/stock_surface.h"

namespace render {
namespace {

using core::Vec3;

core::ExactBody box_body(const Vec3& low, const Vec3& high) {
    return core::convex(core::Aabb{low, high});
}

core::ExactBody pin(const Vec3& foot, double radius, double height) {
    return core::posed(core::convex(core::ProfileElement{0.0, radius, height, radius, 0.0}),
                       core::translation(foot));
}

/// The moves of one tool, and where its tip goes.
class Moves {
public:
    Moves(std::vector<core::CutterSweep>& sweeps, std::vector<PathPoint>& path)
        : sweeps_(sweeps), path_(path) {}

    void tool(std::shared_ptr<const core::Cutter> cutter, const Vec3& at) {
        cutter_ = std::move(cutter);
        at_ = at;
        add(at, ClearanceState::none, true, true);
    }
    void rapid(const Vec3& to, ClearanceState state = ClearanceState::clear) {
        add(to, state, true, false);
        at_ = to;
        ++block_;
    }
    void feed(const Vec3& to, ClearanceState state = ClearanceState::clear) {
        piece(to, state);
        ++block_;
    }
    void circle(const Vec3& middle, double radius) {
        for (int i = 0; i <= 48; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / 48;
            piece(middle + radius * Vec3(std::cos(angle), std::sin(angle), 0.0),
                  ClearanceState::clear);
        }
        ++block_;
    }

private:
    void piece(const Vec3& to, ClearanceState state) {
        sweeps_.push_back({cutter_, at_, to, core::Mat3(1.0), block_});
        add(to, state, false, false);
        at_ = to;
    }
    void add(const Vec3& p, ClearanceState state, bool rapid, bool begins) {
        path_.push_back({glm::vec3(p), block_, state, rapid, begins});
    }

    std::vector<core::CutterSweep>& sweeps_;
    std::vector<PathPoint>& path_;
    std::shared_ptr<const core::Cutter> cutter_;
    Vec3 at_ = Vec3(0.0);
    uint32_t block_ = 0;
};

void pocket(Moves& moves) {
    moves.tool(flat_cutter(5.0), {-20, 0, 30});
    for (const double z : {-3.0, -6.0, -9.0}) {
        moves.rapid({-20, 8, 3});
        moves.feed({-20, 8, z});
        for (const double in : {0.0, 4.0, 8.0, 12.0}) {
            const double x0 = -34 + in, x1 = 14 - in, y0 = -6 + 0.55 * in, y1 = 22 - 0.55 * in;
            moves.feed({x0, y0, z});
            moves.feed({x1, y0, z});
            moves.feed({x1, y1, z}, in < 1.0 ? ClearanceState::near : ClearanceState::clear);
            moves.feed({x0, y1, z});
            moves.feed({x0, y0, z});
        }
    }
    moves.circle({-12, 6, -11}, 7.0);
    moves.rapid({-12, 6, 20});
}

} // namespace

std::shared_ptr<const core::Cutter> flat_cutter(double radius) {
    return std::make_shared<core::Cutter>(core::make_cutter({{{0, radius, 40, radius, 0}}}, 0.0));
}

std::shared_ptr<const core::Cutter> ball_cutter(double radius) {
    return std::make_shared<core::Cutter>(core::make_cutter(
        {{{radius, 0, radius, 0, radius}, {radius, radius, 40, radius, 0}}}, 0.0));
}

core::Setup sample_setup() {
    core::Setup setup;
    setup.stock.shape = core::SolidBox{{{-45, -30, -30}, {45, 30, 0}}};
    const auto fixture = [&](const char* name, core::ExactBody body, bool machine = false) {
        setup.fixtures.push_back({.name = name, .body = std::move(body), .is_machine = machine});
    };
    fixture("fixed jaw", box_body({-62, -62, -56}, {62, -30, -10}));
    fixture("moving jaw", box_body({-62, 30, -56}, {62, 56, -10}));
    fixture("vice bed", box_body({-62, -62, -66}, {62, 56, -42}));
    fixture("parallel", box_body({-45, -28, -42}, {45, -22, -30}));
    fixture("clamp-1", box_body({22, -52, 0}, {42, -12, 9}));
    fixture("clamp-1 heel", box_body({22, -52, -10}, {42, -44, 0}));
    fixture("stud", pin({32, -36, 9}, 6.0, 14.0));
    for (int i = -2; i <= 2; ++i)
        fixture("table", box_body({44.0 * i - 18, -160, -86}, {44.0 * i + 18, 160, -66}), true);
    fixture("table bed", box_body({-106, -160, -100}, {106, 160, -76}), true);
    return setup;
}

core::ToolAssembly sample_tool() {
    core::ToolAssembly tool;
    tool.parts = {
        {core::PartKind::flutes, {{{1.0, 7.0, 1.0, 7.0, 1.0}, {1.0, 8.0, 22.0, 8.0, 0.0}}}},
        {core::PartKind::shank, {{{22.0, 8.0, 40.0, 8.0, 0.0}}}},
        {core::PartKind::holder,
         {{{32.0, 15.0, 36.0, 18.0, 0.0},
           {36.0, 18.0, 70.0, 22.0, 0.0},
           {70.0, 31.5, 79.0, 31.5, 0.0},
           {79.0, 26.0, 85.0, 26.0, 0.0},
           {85.0, 31.5, 96.0, 31.5, 0.0},
           {96.0, 22.0, 140.0, 12.0, 0.0}}}}};
    tool.length = 96.0;
    return tool;
}

std::vector<core::CutterSweep> sample_moves(std::vector<PathPoint>& path) {
    std::vector<core::CutterSweep> sweeps;
    Moves moves(sweeps, path);
    pocket(moves);
    moves.tool(flat_cutter(4.0), {28, 22, 20});
    for (const Vec3& hole : {Vec3(28, 20, 0), Vec3(28, 2, 0)}) {
        moves.rapid({hole.x, hole.y, 3});
        moves.feed({hole.x, hole.y, -14});
        moves.rapid({hole.x, hole.y, 12});
    }
    moves.tool(ball_cutter(4.0), {-50, -34, 20});
    for (int pass = 0; pass <= 9; ++pass) {
        const double angle = 0.5 * std::numbers::pi * pass / 9;
        const double y = -38.0 + 14.0 * (1.0 - std::cos(angle));
        const double z = -8.0 - 10.0 + 14.0 * std::sin(angle);
        moves.rapid({-52, y, z});
        moves.feed({12, y, z}, pass > 6 ? ClearanceState::near : ClearanceState::clear);
        moves.rapid({-52, y, 12});
    }
    moves.tool(flat_cutter(8.0), {0, -4, 12});
    moves.rapid({0, -21, 2}, ClearanceState::near);
    moves.feed({6.58, -21, 2}, ClearanceState::violation);
    moves.rapid({6.58, -21, 30});
    return sweeps;
}

StockBricks stock_bricks(const core::CutModel& model) {
    StockSurface surface;
    surface.update(model);
    return surface.bricks();
}

Scene sample_scene(double spacing) {
    const core::Setup setup = sample_setup();
    Scene scene;
    std::vector<PathPoint> points;
    core::CutModel model = *core::make_cut_model(setup.stock, spacing);
    for (const core::CutterSweep& sweep : sample_moves(points)) cut(model, sweep);
    scene.stock = stock_bricks(model);
    scene.bodies = setup_bodies(setup, setup_meshes(setup), {});
    const core::ToolAssembly tool = sample_tool();
    core::AxisValues values{6.58, -21.0, 2.0 + tool.length};
    for (Body& body : tool_bodies(setup, tool, tool_meshes(tool), values))
        scene.bodies.push_back(std::move(body));
    scene.current_block = points[points.size() - 2].block;
    scene.path = std::make_shared<const ToolPath>(tool_path(std::move(points)));
    scene.witness = Witness{{14.58, -21.0, 6.0}, {22.0, -21.0, 6.0}, ClearanceState::violation};
    for (Body& body : scene.bodies)
        if (body.name == "holder" || body.name == "clamp-1")
            body.side = body.name == "holder" ? PairSide::tool : PairSide::body;
    scene.triads = {{.name = "G54", .origin = {-45, -30, 0}},
                    {.name = "machine zero", .origin = {70, 60, 40}, .is_minor = true}};
    scene.ground = Ground{core::translation({-45, -30, -66})};
    return scene;
}

} // namespace render
