#pragma once

#include <map>
#include <string>
#include <vector>

#include "app/check/check_run.h"
#include "app/report/html/html_cards.h"
#include "render/camera.h"
#include "render/scene.h"

namespace app {

/// As run_check, and adds what a report shows of the worst blocks: pictures, if there is OpenGL,
/// and scenes. The program is run once; places are had again from the record.
///
/// Errors: as run_check.
/// Cost:   some 0.2 s for each picture, on top of the check.
core::Result<CheckRun> run_pictured_check(const CheckJob& job, ReportViews& views);

/// Writes scenes for the 3D view of a page. What several of them share is written once.
class SceneWriter {
public:
    /// A JSON object: bodies with their places, the path, the current block's by itself, the
    /// witness, the camera. Bodies of the machine are left out, unless they are one of the pair.
    ///
    /// Frame: that of the stock, mm.
    std::string add(const render::Scene& scene, const render::Camera& camera);

    /// The meshes that scenes refer to, as a JSON array.
    std::string meshes() const;

private:
    /// The number of a mesh; empty when nothing is left of it.
    std::optional<size_t> mesh_of(const render::SharedMesh& mesh);
    std::optional<size_t> stock_of(const render::StockBricks& bricks);
    std::optional<size_t> put(const render::TriangleMesh& mesh);
    std::string body_json(const render::Body& body, size_t mesh) const;
    std::string bodies_json(const render::Scene& scene);

    std::vector<std::string> meshes_;
    std::vector<render::SharedMesh> kept_; // so that no other mesh gets their addresses
    std::map<const render::TriangleMesh*, std::optional<size_t>> known_;
    std::vector<std::pair<render::StockBricks, std::optional<size_t>>> stocks_;
};

/// A mesh as a JSON object: places as 16-bit steps across its box, normals and tints as 8-bit
/// numbers, corners, all in one base64 text.
std::string mesh_json(const render::TriangleMesh& mesh);

} // namespace app
