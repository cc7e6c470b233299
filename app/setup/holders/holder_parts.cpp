#include "app/setup/holders/holder_parts.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "core/base/text.h"
#include "core/base/units.h"

namespace app {
namespace {

constexpr double inch = core::mm_per_inch;

constexpr std::string_view cat_source =
    "Flange: ANSI B5.50, d5, f3 and a in the table of the Ingersoll catalogue of 2011, page 776 "
    "(docs.steelcam.org).";
constexpr std::string_view bt_source =
    "Flange: MAS 403, in the table of tool shanks of the Okuma VTM-200 operation manual, page 54 "
    "(manualshive.com).";
constexpr std::string_view typical_taper = "Flange: typical of this taper; measure yours.";

constexpr std::array tapers = {
    HolderTaper{"BT30", "", "BT30, JIS B 6339 and MAS 403", bt_source, 2, 38, 20, 46},
    HolderTaper{"BT40", "", "BT40, JIS B 6339 and MAS 403", bt_source, 2, 50, 25, 63},
    HolderTaper{"CAT40", "", "CAT40, ASME B5.50", cat_source, 0.125 * inch, 50, 0.625 * inch,
                2.5 * inch},
    HolderTaper{"CAT50", "", "CAT50, ASME B5.50", cat_source, 0.125 * inch, 75, 0.625 * inch,
                3.875 * inch},
    HolderTaper{"SK40", "", "SK40, DIN 69871 and ISO 7388", typical_taper, 3.2, 50, 15.9, 63.55},
    HolderTaper{"HSK-A63", "HSK63A", "HSK-A63, DIN 69893 and ISO 12164", typical_taper, 0, 0, 26,
                63},
    HolderTaper{"ISO20", "", "ISO20, for small spindles with a tool changer", typical_taper, 2, 26,
                12, 35},
    HolderTaper{"R8", "", "R8, without a flange",
                "The gauge line is the face of the spindle, from which tools are measured.", 0, 0,
                0, 0},
    HolderTaper{"ROUTER", "", "Spindle of a router, whose nut holds the collet itself",
                "The gauge line is the face of the spindle's housing; the body is the end of its "
                "shaft.",
                0, 0, 0, 0},
};

struct KindEntry {
    HolderKind kind;
    std::string_view title, source;
};

constexpr std::array kinds = {
    KindEntry{HolderKind::collet_chuck, "Collet chucks",
              "Nuts: usual sizes of DIN 6499; the body is typical, and not thicker than the nut."},
    KindEntry{HolderKind::side_lock, "End-mill holders with side lock",
              "Diameters: usual sizes of DIN 1835 for mm, typical ones for inches."},
    KindEntry{HolderKind::shrink_fit, "Shrink-fit chucks",
              "Diameters: usual sizes of DIN 69882, with flanks of 4.5 degrees."},
    KindEntry{HolderKind::hydraulic, "Hydraulic chucks",
              "Diameters: usual sizes of DIN 69882; the thicker body behind the nose is typical."},
    KindEntry{HolderKind::shell_mill, "Shell-mill arbors",
              "Diameters of the seat: typical of DIN 6357; its lower face carries the mill."},
    KindEntry{HolderKind::drill_chuck, "Drill chucks",
              "All sizes are typical, with the jaws at the lower face."},
    KindEntry{HolderKind::tapping_chuck, "Tapping chucks",
              "All sizes are typical of quick-change chucks with their adapter."},
};

const KindEntry& entry_of(HolderKind kind) {
    const auto found =
        std::find_if(kinds.begin(), kinds.end(), [&](const auto& e) { return e.kind == kind; });
    assert(found != kinds.end());
    return *found;
}

// --- attachments ---

HolderAttachment collet_chuck(int size, double front, double cone, double nut, double height,
                              double body) {
    return {fmt::format("ER{}", size),
            HolderKind::collet_chuck,
            fmt::format("collet chuck ER{}", size),
            static_cast<double>(size),
            false,
            front,
            cone,
            nut,
            height,
            body};
}

HolderAttachment side_lock(double size, bool is_inch, double diameter) {
    const std::string number = core::number_text(size, 3);
    return {fmt::format("EM{}{}", number, is_inch ? "in" : ""),
            HolderKind::side_lock,
            fmt::format("end-mill holder with side lock, {} {}", number, is_inch ? "inch" : "mm"),
            size,
            is_inch,
            diameter - 2.0,
            1.0,
            0.0,
            0.0,
            diameter};
}

HolderAttachment shrink_fit(int size, double front, double body, double cone) {
    return {fmt::format("SF{}", size),
            HolderKind::shrink_fit,
            fmt::format("shrink-fit chuck, {} mm", size),
            static_cast<double>(size),
            false,
            front,
            cone,
            0.0,
            0.0,
            body};
}

/// A chuck with a head below a body: a hydraulic or a tapping chuck.
HolderAttachment headed(const char* letters, int size, HolderKind kind, std::string title,
                        double head, double height, double body) {
    return {fmt::format("{}{}", letters, size),
            kind,
            std::move(title),
            static_cast<double>(size),
            false,
            0.0,
            0.0,
            head,
            height,
            body};
}

HolderAttachment hydraulic(int size, double head) {
    const double body = std::max(head, 50.0);
    return headed("HC", size, HolderKind::hydraulic, fmt::format("hydraulic chuck, {} mm", size),
                  head, 24.0, body);
}

HolderAttachment shell_mill(int size, double diameter) {
    return headed("SM", size, HolderKind::shell_mill,
                  fmt::format("shell-mill arbor, spigot {} mm", size), 0.0, 0.0, diameter);
}

HolderAttachment drill_chuck(int size, double front, double cone, double diameter) {
    return {fmt::format("DC{}", size),
            HolderKind::drill_chuck,
            fmt::format("drill chuck up to {} mm", size),
            static_cast<double>(size),
            false,
            front,
            cone,
            0.0,
            0.0,
            diameter};
}

HolderAttachment tapping_chuck(int size, double head, double height, double body) {
    return headed("TC", size, HolderKind::tapping_chuck,
                  fmt::format("tapping chuck up to M{}", size), head, height, body);
}

std::vector<HolderAttachment> all_attachments() {
    std::vector<HolderAttachment> all = {
        collet_chuck(11, 16, 1.5, 19, 11.3, 19),
        collet_chuck(16, 24, 2, 28, 17.5, 28),
        collet_chuck(20, 29, 2.5, 34, 19, 34),
        collet_chuck(25, 37, 2.5, 42, 20, 42),
        collet_chuck(32, 43, 3.5, 50, 22.5, 46),
        collet_chuck(40, 55, 4, 63, 25.5, 63),
        side_lock(6, false, 25),
        side_lock(8, false, 28),
        side_lock(10, false, 35),
        side_lock(12, false, 42),
        side_lock(14, false, 44),
        side_lock(16, false, 48),
        side_lock(18, false, 50),
        side_lock(20, false, 52),
        side_lock(25, false, 65),
        side_lock(32, false, 72),
        side_lock(0.25, true, 0.875 * inch),
        side_lock(0.375, true, 1.0625 * inch),
        side_lock(0.5, true, 1.375 * inch),
        side_lock(0.625, true, 1.625 * inch),
        side_lock(0.75, true, 1.875 * inch),
        side_lock(1, true, 2.25 * inch),
        side_lock(1.25, true, 2.75 * inch),
        shrink_fit(6, 21, 27, 38.12),
        shrink_fit(8, 21, 27, 38.12),
        shrink_fit(10, 24, 32, 50.82),
        shrink_fit(12, 24, 32, 50.82),
        shrink_fit(14, 27, 34, 44.47),
        shrink_fit(16, 27, 34, 44.47),
        shrink_fit(18, 33, 42, 57.18),
        shrink_fit(20, 33, 42, 57.18),
        shrink_fit(25, 44, 53, 57.18),
        shrink_fit(32, 44, 53, 57.18),
        shell_mill(16, 38),
        shell_mill(22, 48),
        shell_mill(27, 60),
        shell_mill(32, 78),
        shell_mill(40, 89),
        drill_chuck(8, 24, 6, 36),
        drill_chuck(13, 34, 8, 50),
        drill_chuck(16, 40, 8, 57),
        tapping_chuck(12, 33, 25, 40),
        tapping_chuck(20, 50, 34, 56),
    };
    constexpr double heads[][2] = {{6, 26},  {8, 28},  {10, 30}, {12, 32}, {14, 34},
                                   {16, 38}, {18, 40}, {20, 42}, {25, 57}, {32, 64}};
    for (const auto& [size, head] : heads) all.push_back(hydraulic(static_cast<int>(size), head));
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return a.kind < b.kind; });
    return all;
}

// --- which fit, and how long they are ---

/// A size and what belongs to it.
struct SizeValue {
    double size, value;
};

/// The value of the first size that is not less; that of the last if all are.
double value_for(std::span<const SizeValue> table, double size) {
    for (const SizeValue& row : table)
        if (size <= row.size) return row.value;
    return table.back().value;
}

constexpr SizeValue hsk_side_locks[] = {{10, 65}, {20, 80}, {32, 110}};
constexpr SizeValue side_locks[] = {{8, 50}, {20, 63}, {25, 90}, {32, 100}};
constexpr SizeValue r8_side_locks[] = {{20, 50}, {32, 65}};
constexpr SizeValue hsk_shrink_fits[] = {{8, 80},   {10, 85},  {14, 90}, {18, 95},
                                         {20, 100}, {25, 115}, {32, 120}};
constexpr SizeValue shrink_fits[] = {{20, 90}, {32, 115}};
constexpr SizeValue hydraulics[] = {{20, 90}, {32, 115}};
constexpr SizeValue hsk_shell_mills[] = {{22, 50}, {40, 60}};
constexpr SizeValue shell_mills[] = {{27, 55}, {40, 60}};

/// The largest size of a kind that a small taper takes; 0 for none.
double largest_of(std::string_view taper, HolderKind kind) {
    constexpr double any = 1e9;
    const bool is_collet = kind == HolderKind::collet_chuck;
    if (taper == "ROUTER") return is_collet ? any : 0.0;
    if (taper == "ISO20") return is_collet ? 20.0 : 0.0;
    if (taper == "R8")
        return kind == HolderKind::shrink_fit || kind == HolderKind::hydraulic ? 0.0
               : kind == HolderKind::shell_mill                                ? 27.0
                                                                               : any;
    if (taper != "BT30") return any;
    switch (kind) {
    case HolderKind::side_lock:
    case HolderKind::hydraulic:
        return 20.0;
    case HolderKind::shrink_fit:
    case HolderKind::tapping_chuck:
        return 16.0;
    case HolderKind::shell_mill:
        return 27.0;
    default:
        return any;
    }
}

double size_in_mm(const HolderAttachment& attachment) {
    return attachment.is_inch ? attachment.size * inch : attachment.size;
}

double length_in_r8(const HolderAttachment& attachment) {
    switch (attachment.kind) {
    case HolderKind::side_lock:
        return value_for(r8_side_locks, size_in_mm(attachment));
    case HolderKind::shell_mill:
        return 40.0;
    case HolderKind::drill_chuck:
    case HolderKind::tapping_chuck:
        return 75.0;
    default:
        return 65.0;
    }
}

} // namespace

std::span<const HolderTaper> holder_tapers() { return tapers; }

std::string_view title_of(HolderKind kind) { return entry_of(kind).title; }

std::string_view source_of(HolderKind kind) { return entry_of(kind).source; }

std::span<const HolderAttachment> holder_attachments() {
    static const std::vector<HolderAttachment> all = all_attachments();
    return all;
}

std::string why_no_holder(const HolderTaper& taper, const HolderAttachment& attachment) {
    const bool takes_inches = taper.name.starts_with("CAT") || taper.name == "R8";
    if (attachment.is_inch && !takes_inches)
        return fmt::format("{} holders have shanks in mm", taper.name);
    const double largest = largest_of(taper.name, attachment.kind);
    if (largest == 0.0) return fmt::format("there is no {} with {}", attachment.title, taper.name);
    if (attachment.size > largest)
        return fmt::format("{} is too large for {}", attachment.name, taper.name);
    return {};
}

double usual_length(const HolderTaper& taper, const HolderAttachment& attachment) {
    if (taper.name == "ROUTER") return attachment.head_height + 15.0;
    if (taper.name == "ISO20") return 45.0;
    if (taper.name == "R8") return length_in_r8(attachment);
    const bool is_hsk = taper.name == "HSK-A63";
    const double size = size_in_mm(attachment);
    switch (attachment.kind) {
    case HolderKind::collet_chuck:
        return is_hsk ? 100.0 : 70.0;
    case HolderKind::side_lock:
        return is_hsk ? value_for(hsk_side_locks, size) : value_for(side_locks, size);
    case HolderKind::shrink_fit:
        return is_hsk ? value_for(hsk_shrink_fits, size) : value_for(shrink_fits, size);
    case HolderKind::hydraulic:
        return value_for(hydraulics, size);
    case HolderKind::shell_mill:
        return is_hsk ? value_for(hsk_shell_mills, size) : value_for(shell_mills, size);
    case HolderKind::drill_chuck:
    case HolderKind::tapping_chuck:
        return 100.0;
    }
    return 100.0;
}

} // namespace app
