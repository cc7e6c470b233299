#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "core/base/result.h"

namespace gcode {

/// A place of the ZX plane, program units: Z is the real part, X the imaginary one.
using ZxPoint = std::complex<double>;

/// A piece of an outline. A chamfer is a line, a fillet an arc once their places are known.
struct OutlinePiece {
    enum class Kind : uint8_t { line, arc };
    Kind kind = Kind::line;
    ZxPoint start, end;
    ZxPoint centre{}; // of an arc
    bool counterclockwise = false;
    bool is_corner = false; // to be put between its neighbours
    double corner_size = 0.0;

    bool is_arc() const { return kind == Kind::arc; }
};

/// The contour of a turning cycle in the frame in which it is cut: it runs down in Z and, on the
/// whole, up in X. The first piece is the way in, from the tool's place to the contour.
struct Outline {
    std::vector<OutlinePiece> pieces;
    bool turned = false, x_mirrored = false, z_mirrored = false;
};

/// How near is the same place, program units (as LinuxCNC).
constexpr double zx_tolerance = 1e-6;

/// Turns the outline by a right angle, so that X takes the place of Z.
void turn(Outline& outline);

/// Mirrors the outline so that its pieces lead from great Z and small X to small Z and great X.
void face_cutting_direction(Outline& outline);

/// The place in the lathe's frame of one in the outline's frame.
ZxPoint lathe_from_outline(const Outline& outline, ZxPoint place);

/// Whether mirrors have turned the sense of arcs round.
bool is_reversed(const Outline& outline);

/// Whether a piece never runs back in Z; an arc must also stay on one side of its centre.
bool runs_down(const OutlinePiece& piece);

/// Whether the outline can be cut; a way in that runs back is made straight down first.
///
/// Errors: a piece runs back.
core::Result<void> check_runs_down(Outline& outline);

/// Puts fillets and chamfers between their neighbours, and drops what has no length.
///
/// Errors: a corner does not fit.
core::Result<void> shape_corners(Outline& outline);

/// Moves the outline away from the material by a distance, its way in apart.
///
/// Errors: neighbours that are parallel; nothing is left of the outline.
/// Source: behaves as LinuxCNC's offset, which goes in steps of half of the smallest piece.
core::Result<void> offset_outline(Outline& outline, double distance);

/// The Z of the places where a piece has an X: none, one or two, in the order of the piece's ends
/// if it is level, else the greater first.
std::vector<double> crossings(const OutlinePiece& piece, double x);

} // namespace gcode
