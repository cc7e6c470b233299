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

/// As run_check, and adds what a report shows of the worst blocks: pictures, if there is OpenGL,
/// and scenes. The program is run once; places are had again from the record.
///
/// Errors: as run_check.
/// Cost:   some 0.2 s for each picture, on top of the check.
core::Result<CheckRun> run_pictured_check(const CheckJob& job, ReportViews& views);

/// Writes scenes for the 3D view of a page. What several of them share is written once.
class SceneWriter {
public:
    SceneWriter();
    ~SceneWriter();

    /// A JSON object: bodies with their places, the path, the current block's by itself, the
    /// witness, the camera. Bodies of the machine are left out, unless they are one of the pair.
    ///
    /// Frame: that of the stock, mm.
    std::string add(const render::Scene& scene, const render::Camera& camera);

    /// The meshes that scenes refer to, as a JSON array.
    std::string meshes() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// A mesh as a JSON object: places as 16-bit steps across its box, normals and tints as 8-bit
/// numbers, corners, all in one base64 text.
std::string mesh_json(const render::TriangleMesh& mesh);

} // namespace app
