#pragma once

#include <memory>
#include <string>

#include "core/base/result.h"

namespace render {
struct Camera;
struct Scene;
struct TriangleMesh;
} // namespace render

namespace app {

struct CheckJob;
struct CheckRun;
struct ReportViews;

/// As run_check, and adds what a report shows of the worst blocks: pictures, if OpenGL works, and
/// scenes. Runs the program once; poses come from the record.
///
/// Errors: as run_check.
/// Cost:   about 0.2 s per picture, in addition to the check.
core::Result<CheckRun> run_pictured_check(const CheckJob& job, ReportViews& views);

/// Writes scenes for the 3D view of a page. Meshes shared by several scenes are written once.
class SceneWriter {
public:
    SceneWriter();
    ~SceneWriter();

    /// A JSON object: bodies with their poses, the path, that of the current block separately, the
    /// witness, the camera. Machine bodies are omitted unless they belong to the pair.
    ///
    /// Frame: that of the stock, mm.
    std::string add(const render::Scene& scene, const render::Camera& camera);

    /// The meshes that scenes refer to, as a JSON array.
    std::string meshes() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// A mesh as a JSON object: vertex positions as 16-bit steps across its box, normals and tints as
/// 8-bit numbers, and triangle indices, all in one base64 text.
std::string mesh_json(const render::TriangleMesh& mesh);

} // namespace app
