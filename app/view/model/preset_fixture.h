#pragma once

#include <optional>
#include <string>

namespace app {
struct Preset;
struct StatedBody;
} // namespace app

namespace app::viewer {

struct ViewModel;

/// Adds a preset as a fixture and selects it: a vise closed on the stock, turned if that is too
/// wide for it in Y, a plate below it, anything else beside it.
void add_preset(ViewModel& model, const Preset& preset);

/// How deep a vise holds the stock if nobody says it: half its height, at most that of the jaws,
/// mm. Empty if this body is not a vise in the frame of the stock, or not turned by quarter turns.
std::optional<double> usual_grip(const ViewModel& model, const StatedBody& body);

/// Puts a vise around the stock, so deep in its jaws, and closes it.
void clamp_stock(ViewModel& model, const StatedBody& body, double depth);

} // namespace app::viewer
