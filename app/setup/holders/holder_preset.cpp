#include "app/setup/holders/holder_preset.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

#include <fmt/format.h>

#include "app/setup/presets/preset_lists.h"
#include "app/setup/presets/preset_solid.h"
#include "core/base/math.h"
#include "core/base/text.h"

namespace app {
namespace {

using core::ConeStep;

/// The nearest multiple of 1e-6 mm: the number that a person would write.
double plain_length(double mm) { return core::round(mm * 1e6) / 1e6; }

double size_or_zero(const PresetSizes& sizes, std::string_view key) {
    return sizes.has(key) ? sizes[key] : 0.0;
}

/// The head below the body: a nut, or the nose of a chuck.
struct Head {
    double diameter = 0.0, height = 0.0;
};

Head head_of(const PresetSizes& sizes) {
    if (sizes.has("nut_height")) return {sizes["nut_diameter"], sizes["nut_height"]};
    return {size_or_zero(sizes, "nose_diameter"), size_or_zero(sizes, "nose_height")};
}

core::Result<std::vector<ConeStep>> cones_of(const PresetSizes& sizes) {
    const Head head = head_of(sizes);
    const double front = size_or_zero(sizes, "front_height"), body = sizes["body_diameter"];
    const double flange = size_or_zero(sizes, "flange_height"), gap = size_or_zero(sizes, "gap");
    const double below = std::max(front, head.height);
    const double rest = plain_length(sizes["length"] - below - flange - gap);
    if (head.height > 0.0 && front > head.height)
        return unfit_sizes("front_height must not be more than nut_height, which includes it");
    if (rest < 0.0)
        return unfit_sizes(fmt::format("length must be at least {} mm: the other heights take that "
                                       "much",
                                       core::number_text(below + flange + gap, 3)));
    std::vector<ConeStep> cones;
    const auto add = [&cones](double lower, double upper, double length) {
        if (length > 0.0) cones.push_back({lower, upper, length});
    };
    if (front > 0.0) add(sizes["front_diameter"], head.height > 0.0 ? head.diameter : body, front);
    add(head.diameter, head.diameter, plain_length(std::max(head.height - front, 0.0)));
    add(body, body, rest);
    add(size_or_zero(sizes, "flange_diameter"), size_or_zero(sizes, "flange_diameter"), flange);
    add(size_or_zero(sizes, "gap_diameter"), size_or_zero(sizes, "gap_diameter"), gap);
    return cones;
}

// --- the mesh ---

/// A closed surface of revolution about Z, with polygons around its circles.
class Turned {
public:
    explicit Turned(double greatest_radius)
        : circle_(around_circle({0.0, 0.0}, greatest_radius)), greatest_(greatest_radius) {}

    /// Goes on to a circle; the first one closes the lower end.
    void go_to(double radius, double z) {
        const uint32_t first = static_cast<uint32_t>(mesh_.vertices.size());
        for (const PlanPoint& p : circle_)
            mesh_.vertices.push_back({p[0] * radius / greatest_, p[1] * radius / greatest_, z});
        if (first == 0)
            close(z, false);
        else
            join(last_, first);
        last_ = first;
    }

    core::Mesh finished(double z) {
        close(z, true);
        return std::move(mesh_);
    }

private:
    uint32_t corners() const { return static_cast<uint32_t>(circle_.size()); }

    void join(uint32_t below, uint32_t above) {
        for (uint32_t i = 0; i < corners(); ++i) {
            const uint32_t next = (i + 1) % corners();
            mesh_.triangles.push_back({below + i, below + next, above + next});
            mesh_.triangles.push_back({below + i, above + next, above + i});
        }
    }

    void close(double z, bool is_top) {
        const uint32_t centre = static_cast<uint32_t>(mesh_.vertices.size());
        const uint32_t ring = is_top ? last_ : 0;
        mesh_.vertices.push_back({0.0, 0.0, z});
        for (uint32_t i = 0; i < corners(); ++i) {
            const uint32_t next = (i + 1) % corners();
            mesh_.triangles.push_back(is_top ? core::Mesh::Corners{centre, ring + i, ring + next}
                                             : core::Mesh::Corners{centre, ring + next, ring + i});
        }
    }

    Outline circle_;
    double greatest_;
    core::Mesh mesh_{};
    uint32_t last_ = 0;
};

core::Result<core::Mesh> mesh_of_holder(const PresetSizes& sizes) {
    FEELER_TRY(const std::vector<ConeStep> cones, cones_of(sizes));
    double greatest = 0.0;
    for (const ConeStep& cone : cones)
        greatest = std::max({greatest, cone.lower_diameter / 2, cone.upper_diameter / 2});
    Turned solid(greatest);
    double z = 0.0, radius = -1.0;
    for (const ConeStep& cone : cones) {
        if (cone.lower_diameter / 2 != radius) solid.go_to(cone.lower_diameter / 2, z);
        radius = cone.upper_diameter / 2;
        z += cone.length;
        solid.go_to(radius, z);
    }
    return solid.finished(z);
}

// --- the list ---

constexpr double widest = 400.0, longest = 1000.0; // mm

PresetParameter size(std::string_view key, double standard, std::string_view meaning,
                     double least = 1.0, double greatest = widest) {
    return {key, standard, least, greatest, meaning};
}

void add_lower_parts(const HolderAttachment& a, std::vector<PresetParameter>& list) {
    if (a.front_height > 0.0) {
        list.push_back(size("front_diameter", a.front_diameter, "diameter of the lower face"));
        list.push_back(
            size("front_height", a.front_height, "height of the cone above it", 0.0, longest));
    }
    if (a.head_height == 0.0) return;
    const bool is_nut = a.kind == HolderKind::collet_chuck;
    list.push_back(is_nut ? size("nut_diameter", a.head_diameter, "diameter of the nut")
                          : size("nose_diameter", a.head_diameter, "diameter of the lower part"));
    list.push_back(
        is_nut ? size("nut_height", a.head_height, "height of the nut, with its cone", 0.1, longest)
               : size("nose_height", a.head_height, "height of that part", 0.1, longest));
}

std::vector<PresetParameter> holder_parameters(const HolderTaper& taper,
                                               const HolderAttachment& a) {
    std::vector<PresetParameter> list = {size(
        "length", usual_length(taper, a), "from the gauge line to the lower face", 1.0, longest)};
    add_lower_parts(a, list);
    list.push_back(size("body_diameter", a.body_diameter, "diameter from there to the flange"));
    if (taper.flange_height > 0.0) {
        list.push_back(size("flange_diameter", taper.flange_diameter, "diameter of the flange"));
        list.push_back(
            size("flange_height", taper.flange_height, "height of the flange", 0.1, longest));
    }
    if (taper.gap > 0.0) {
        list.push_back(size("gap", taper.gap, "from the flange to the gauge line", 0.0, 50.0));
        list.push_back(size("gap_diameter", taper.gap_diameter, "diameter of the holder there"));
    }
    return list;
}

/// A text that lives as long as the program.
std::string_view kept(std::string text) {
    static std::deque<std::string> texts;
    return texts.emplace_back(std::move(text));
}

HolderPreset holder_preset(const HolderTaper& taper, const HolderAttachment& attachment) {
    return {{kept(fmt::format("{}-{}", taper.name, attachment.name)), PresetKind::holder,
             kept(fmt::format("{}: {}", taper.title, attachment.title)),
             kept(fmt::format("{} {}", taper.source, source_of(attachment.kind))),
             "In the middle of the lower face, where the tool comes out. Z up to the gauge line.",
             holder_parameters(taper, attachment), mesh_of_holder},
            &taper,
            &attachment};
}

std::vector<HolderPreset> all_holders() {
    std::vector<HolderPreset> all;
    for (const HolderTaper& taper : holder_tapers())
        for (const HolderAttachment& attachment : holder_attachments())
            if (why_no_holder(taper, attachment).empty())
                all.push_back(holder_preset(taper, attachment));
    return all;
}

// --- names ---

/// The name with that of its taper in place of another spelling.
std::string canonical(std::string_view name) {
    for (const HolderTaper& taper : holder_tapers())
        if (!taper.alias.empty() && name.starts_with(taper.alias)
            && name.substr(taper.alias.size()).starts_with("-"))
            return std::string(taper.name) + std::string(name.substr(taper.alias.size()));
    return std::string(name);
}

/// A plain decimal number, such as 100 or 62.5.
std::optional<double> length_in(std::string_view text) {
    const bool is_plain = !text.empty() && text.size() < 12 && text.front() != '.'
                          && text.find_first_not_of("0123456789.") == std::string_view::npos
                          && std::count(text.begin(), text.end(), '.') < 2;
    if (!is_plain) return std::nullopt;
    double whole = 0.0, scale = 1.0;
    bool is_fraction = false;
    for (const char c : text) {
        if (c == '.')
            is_fraction = true;
        else
            whole = 10.0 * whole + (c - '0');
        if (is_fraction && c != '.') scale *= 10.0;
    }
    return whole / scale;
}

/// Why a taper and an attachment that both exist make no holder; empty if they do not.
std::string why_not_together(std::string_view name) {
    for (const HolderTaper& taper : holder_tapers())
        for (const HolderAttachment& attachment : holder_attachments()) {
            const std::string whole = fmt::format("{}-{}", taper.name, attachment.name);
            if (name == whole || name.starts_with(whole + "-"))
                return why_no_holder(taper, attachment);
        }
    return {};
}

std::string unknown_holder_text(std::string_view name, std::string_view wanted) {
    std::string text = fmt::format("there is no holder \"{}\"", name);
    if (const std::string why = why_not_together(wanted); !why.empty())
        return fmt::format("{}: {}", text, why);
    std::vector<std::string> names;
    for (const HolderPreset& holder : holder_presets()) names.emplace_back(holder.preset.name);
    const std::string nearest = core::nearest_name(core::upper_case(wanted), names);
    const bool is_near = core::edit_distance(core::upper_case(wanted), nearest) * 2 <= name.size();
    if (is_near) text += fmt::format("; did you mean \"{}\"?", nearest);
    return text + " \"feeler presets\" lists all; a length in mm can follow, as in BT40-ER32-100";
}

/// A holder with its cones at its usual length.
struct KnownHolder {
    const HolderPreset* holder;
    std::vector<ConeStep> cones;
};

const std::vector<KnownHolder>& known_holders() {
    static const std::vector<KnownHolder> all = [] {
        std::vector<KnownHolder> made;
        for (const HolderPreset& holder : holder_presets())
            made.push_back({&holder, holder_cones(holder).value_or(std::vector<ConeStep>{})});
        return made;
    }();
    return all;
}

bool are_same_cones(const std::vector<ConeStep>& a, const std::vector<ConeStep>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& one, const auto& two) {
        return one.lower_diameter == two.lower_diameter && one.upper_diameter == two.upper_diameter
               && one.length == two.length;
    });
}

} // namespace

std::span<const HolderPreset> holder_presets() {
    static const std::vector<HolderPreset> all = all_holders();
    return all;
}

core::Result<NamedHolder> holder_named(std::string_view name) {
    const std::string wanted = canonical(name);
    const HolderPreset* found = nullptr;
    for (const HolderPreset& holder : holder_presets()) {
        const std::string_view own = holder.preset.name;
        if (wanted == own) return NamedHolder{&holder, {}};
        const bool begins = wanted.starts_with(own) && wanted[own.size()] == '-';
        if (begins && (!found || own.size() > found->preset.name.size())) found = &holder;
    }
    const auto length =
        found ? length_in(std::string_view(wanted).substr(found->preset.name.size() + 1))
              : std::nullopt;
    if (!length) return unfit_sizes(unknown_holder_text(name, wanted));
    return NamedHolder{found, {{"length", *length}}};
}

core::Result<std::vector<ConeStep>> holder_cones(const HolderPreset& holder,
                                                 const PresetValues& values) {
    for (const auto& [key, value] : values)
        if (const auto checked = check_preset_value(holder.preset, key, value); !checked)
            return tl::unexpected(checked.error());
    return cones_of(PresetSizes(holder.preset.parameters, values));
}

core::Result<std::vector<ConeStep>> holder_cones(std::string_view name) {
    FEELER_TRY(const NamedHolder named, holder_named(name));
    return holder_cones(*named.holder, named.values);
}

std::string name_of_holder(const std::vector<ConeStep>& cones) {
    const double length = plain_length(core::total_length(cones));
    for (const KnownHolder& known : known_holders()) {
        if (are_same_cones(known.cones, cones)) return std::string(known.holder->preset.name);
        const bool may_be_longer =
            !cones.empty() && !known.cones.empty()
            && known.cones.back().upper_diameter == cones.back().upper_diameter
            && known.cones.front().lower_diameter == cones.front().lower_diameter;
        if (!may_be_longer) continue;
        const auto longer = holder_cones(*known.holder, {{"length", length}});
        if (longer && are_same_cones(*longer, cones))
            return fmt::format("{}-{}", known.holder->preset.name, core::number_text(length, 6));
    }
    return {};
}

} // namespace app
