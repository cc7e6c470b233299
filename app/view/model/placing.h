#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/geom/feature_pick.h"
#include "core/geom/placement.h"

namespace app::viewer {

class BodyFeatures;
enum class PickGoal : uint8_t;
struct ViewModel;

/// The name of the stock among the bodies that can be placed; all others are fixtures.
inline constexpr const char* stock_name = "stock";
/// Of the finished part, where it can be meant too.
inline constexpr const char* part_name = "part";

/// A feature of a body. Frame: the scene's.
struct ScenePick {
    std::string body;
    core::FeaturePick feature;

    bool operator==(const ScenePick&) const = default;
};

/// A planar face of a body, for a list. Frame: the scene's.
struct SceneFace {
    std::string name; // such as "+Z  120.00 x 80.00 at 0.00"
    core::FacePlane plane;
};

/// What was found and clicked while a body or a work offset is placed.
struct PickState {
    std::shared_ptr<BodyFeatures> features;
    std::optional<core::FacePlane> first; // face that was clicked first
    std::vector<ScenePick> hovered;       // candidates under the cursor, the most likely first
};

/// The candidate under the cursor that is meant; null if there is none.
const ScenePick* meant_pick(const ViewModel& model);

/// Whether the body of this name can be moved in the window: the stock, or a fixture of the set-up.
bool can_move(const ViewModel& model, const std::string& body);

/// Names of the bodies in the scene that faces can be put to: stock, fixtures, parts of the
/// machine.
std::vector<std::string> bodies_to_meet(const ViewModel& model);

/// The box of a body; empty if there is none of this name. Frame: the scene's.
core::Aabb bounds_of_body(const ViewModel& model, const std::string& body);

/// Bodies that move with a body, because they are positioned in its frame; it is one of them.
std::vector<std::string> moved_with(const ViewModel& model, const std::string& body);

/// Moves a body; those in its frame follow. `by`: in the frame of the scene. One edit, titled
/// `title`. False: it cannot be moved so, and `Workspace::refusal` says why.
bool move_body(ViewModel& model, const std::string& body, const core::Transform& by,
               const std::string& title);

/// States the position of the stock, the part or a fixture in another frame; it stays where it is.
bool change_frame(ViewModel& model, const std::string& body, const std::string& frame);

/// Slides a body along a direction until it first touches another one: closes a jaw, or puts the
/// body down.
bool slide_to_contact(ViewModel& model, const std::string& body, const core::Vec3& direction);

/// Puts a face of a body to another face. Frame of both: the scene's.
bool put_face_to_face(ViewModel& model, const std::string& body, const core::FacePlane& own,
                      const core::FacePlane& other);

/// Puts a body in the middle between two faces.
bool centre_between(ViewModel& model, const std::string& body, const core::FacePlane& a,
                    const core::FacePlane& b);

/// Which of X, Y and Z a feature determines, as for a probe: a corner all, a face the axis across
/// it, an edge or the axis of a bore the two others.
struct ZeroAxes {
    bool axes[3] = {false, false, false};

    bool any() const { return axes[0] || axes[1] || axes[2]; }
};
ZeroAxes zero_axes(const core::FeaturePick& feature);

/// Moves the zero of a work offset to a feature, in the axes that it determines. Bodies stay where
/// they are on the machine: those that are positioned from this zero get new coordinates. The part
/// stays with the zero, as the program does.
bool set_zero(ViewModel& model, const std::string& offset, const core::FeaturePick& feature);

/// Starts to wait for clicks; `none` ends it.
void begin_picking(ViewModel& model, PickGoal goal);

/// What a click at a point of a body can mean now, the most likely first. `reach`: how near corners
/// and edges must be, mm.
std::vector<ScenePick> picks_at(const ViewModel& model, const std::string& body,
                                const core::Vec3& point, double reach);

/// Takes a click on a feature.
void take_pick(ViewModel& model, const ScenePick& pick, double now);

/// What to click next; empty if nothing is waited for.
std::string pick_hint(const ViewModel& model);

/// What a feature is, in words: "bore D12.00", "edge", "face +Z".
std::string words_of(const ViewModel& model, const core::FeaturePick& feature);

/// The largest planar faces of a body, largest first.
std::vector<SceneFace> faces_of(const ViewModel& model, const std::string& body);

/// The outlines of a feature, for drawing it. Frame: the scene's.
std::vector<std::vector<core::Vec3>> outline_of(const ViewModel& model, const ScenePick& pick);

} // namespace app::viewer
