#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace app {

/// What a holder has below the gauge line, from there down: a gap to the face of the spindle, and
/// the flange. mm.
struct HolderTaper {
    std::string_view name;   // "BT40", how names of holders begin
    std::string_view alias;  // another spelling; or empty
    std::string_view title;  // "BT40, JIS B 6339"
    std::string_view source; // of its sizes: a sentence
    double gap, gap_diameter;
    double flange_height, flange_diameter; // 0: it has none
};

/// All tapers, in the order of lists.
std::span<const HolderTaper> holder_tapers();

/// What grips the tool. The order is that of lists.
enum class HolderKind : uint8_t {
    collet_chuck,
    side_lock,
    shrink_fit,
    hydraulic,
    shell_mill,
    drill_chuck,
    tapping_chuck
};

inline constexpr std::array holder_kinds = {HolderKind::collet_chuck, HolderKind::side_lock,
                                            HolderKind::shrink_fit,   HolderKind::hydraulic,
                                            HolderKind::shell_mill,   HolderKind::drill_chuck,
                                            HolderKind::tapping_chuck};

/// "Collet chucks", a heading.
std::string_view title_of(HolderKind kind);
/// Where the sizes of a kind come from: a sentence.
std::string_view source_of(HolderKind kind);

/// The part that grips the tool, from its lower face up: a cone, a head such as a nut, and the body
/// up to the flange. mm.
struct HolderAttachment {
    std::string name; // "ER32", how names of holders end
    HolderKind kind;
    std::string title;                   // "collet chuck ER32"
    double size;                         // the number in its name
    bool is_inch;                        // of the number
    double front_diameter, front_height; // of the lower end of the cone; 0: no cone
    double head_diameter, head_height;   // cone included; 0: no head
    double body_diameter;
};

/// All attachments, by kind, then by size.
std::span<const HolderAttachment> holder_attachments();

/// Why there is no such holder, as a clause; empty if there is one.
std::string why_no_holder(const HolderTaper& taper, const HolderAttachment& attachment);

/// The usual distance from the gauge line to the lower face, mm.
double usual_length(const HolderTaper& taper, const HolderAttachment& attachment);

} // namespace app
