#include "core/dbm/stock_record.h"

#include <cmath>
#include <map>

#include "core/base/byte_record.h"
#include "core/dbm/cut_model.h"
#include "core/geom/mesh.h"

namespace core {
namespace {

constexpr std::string_view magic = "feeler stock 1\n";

enum class ShapeTag : uint8_t { box, cylinder, mesh, deviating_mesh };

/// Properties that a move shares with the previous one, which are therefore not written.
enum SameAsBefore : uint8_t { goes_on = 1, same_cutter = 2, same_attitude = 4, same_block = 8 };

/// FNV-1a, to detect damage.
uint64_t digest_of(std::string_view bytes) {
    uint64_t digest = 0xcbf29ce484222325;
    for (const char c : bytes) digest = (digest ^ static_cast<uint8_t>(c)) * 0x100000001b3;
    return digest;
}

class Reader : public ByteReader {
public:
    using ByteReader::ByteReader;

    double number() {
        const auto value = take<double>();
        ok = ok && std::isfinite(value);
        return value;
    }
    Vec3 vector() {
        const double x = number(), y = number(), z = number();
        return {x, y, z};
    }
    Mat3 matrix() {
        const Vec3 x = vector(), y = vector(), z = vector();
        return {x, y, z};
    }
};

void put_mesh(ByteWriter& out, const Mesh& mesh) {
    out.put(uint64_t{mesh.vertices.size()});
    for (const Vec3& v : mesh.vertices) out.put(v);
    out.put(uint64_t{mesh.triangles.size()});
    for (const Mesh::Corners& corners : mesh.triangles)
        for (const uint32_t corner : corners) out.put(corner);
}

void put_solid(ByteWriter& out, const Solid& solid) {
    out.put(solid.tolerance);
    if (const auto* box = std::get_if<SolidBox>(&solid.shape)) {
        out.put(ShapeTag::box);
        out.put(box->box.min);
        out.put(box->box.max);
    } else if (const auto* cylinder = std::get_if<SolidCylinder>(&solid.shape)) {
        out.put(ShapeTag::cylinder);
        out.put(cylinder->base);
        out.put(cylinder->radius);
        out.put(cylinder->height);
        out.put(static_cast<uint8_t>(cylinder->axis));
    } else {
        out.put(solid.deviation > 0.0 ? ShapeTag::deviating_mesh : ShapeTag::mesh);
        if (solid.deviation > 0.0) out.put(solid.deviation);
        put_mesh(out, *std::get<SolidMesh>(solid.shape).mesh);
    }
}

Mesh get_mesh(Reader& in) {
    Mesh mesh;
    mesh.vertices.resize(in.take_count(24));
    for (Vec3& v : mesh.vertices) v = in.vector();
    mesh.triangles.resize(in.take_count(12));
    for (Mesh::Corners& corners : mesh.triangles)
        for (uint32_t& corner : corners) {
            corner = in.take<uint32_t>();
            in.ok = in.ok && corner < mesh.vertices.size();
        }
    in.ok = in.ok && !mesh.triangles.empty();
    return mesh;
}

Solid get_solid(Reader& in) {
    Solid solid;
    solid.tolerance = in.number();
    in.ok = in.ok && solid.tolerance >= 0.0;
    const auto tag = in.take<ShapeTag>();
    if (tag == ShapeTag::box) {
        const Vec3 min = in.vector(), max = in.vector();
        in.ok = in.ok && min.x < max.x && min.y < max.y && min.z < max.z;
        solid.shape = SolidBox{{min, max}};
    } else if (tag == ShapeTag::cylinder) {
        SolidCylinder cylinder{in.vector(), in.number(), in.number(), in.take<uint8_t>()};
        in.ok = in.ok && cylinder.radius > 0.0 && cylinder.height > 0.0 && cylinder.axis < 3;
        solid.shape = cylinder;
    } else {
        in.ok = in.ok && (tag == ShapeTag::mesh || tag == ShapeTag::deviating_mesh);
        if (tag == ShapeTag::deviating_mesh) solid.deviation = in.number();
        in.ok = in.ok && solid.deviation >= 0.0 && solid.deviation <= solid.tolerance;
        Mesh mesh = get_mesh(in);
        if (in.ok) solid.shape = solid_mesh(std::move(mesh));
    }
    return solid;
}

void put_cutter(ByteWriter& out, const Cutter& cutter) {
    out.put(cutter.path_error);
    out.put(uint64_t{cutter.cutting.elements.size()});
    for (const ProfileElement& e : cutter.cutting.elements)
        for (const double value : {e.z0, e.r0, e.z1, e.r1, e.margin}) out.put(value);
}

std::shared_ptr<const Cutter> get_cutter(Reader& in) {
    const double error = in.number();
    RevolvedProfile flutes;
    flutes.elements.resize(in.take_count(40));
    for (ProfileElement& e : flutes.elements) {
        e = {in.number(), in.number(), in.number(), in.number(), in.number()};
        in.ok = in.ok && e.z0 <= e.z1 && e.r0 >= 0.0 && e.r1 >= 0.0 && e.margin >= 0.0
                && (e.margin == 0.0 || e.z0 == e.z1);
    }
    in.ok = in.ok && error >= 0.0 && !flutes.empty();
    return in.ok ? std::make_shared<const Cutter>(make_cutter(flutes, error)) : nullptr;
}

/// The cutters of a record, each once, in the order of their first move.
struct CutterTable {
    std::vector<const Cutter*> cutters;
    std::map<const Cutter*, uint32_t> numbers;

    explicit CutterTable(const std::vector<CutterSweep>& sweeps) {
        for (const CutterSweep& sweep : sweeps)
            if (numbers.emplace(sweep.cutter.get(), cutters.size()).second)
                cutters.push_back(sweep.cutter.get());
    }
};

void put_sweeps(ByteWriter& out, const std::vector<CutterSweep>& sweeps) {
    const CutterTable table(sweeps);
    out.put(uint64_t{table.cutters.size()});
    for (const Cutter* cutter : table.cutters) put_cutter(out, *cutter);
    out.put(uint64_t{sweeps.size()});
    const CutterSweep none;
    const CutterSweep* last = &none;
    for (const CutterSweep& sweep : sweeps) {
        uint8_t same = 0;
        if (sweep.from == last->to) same |= goes_on;
        if (sweep.cutter == last->cutter) same |= same_cutter;
        if (sweep.orientation == last->orientation) same |= same_attitude;
        out.put(same);
        if (!(same & same_cutter)) out.put(table.numbers.at(sweep.cutter.get()));
        if (!(same & same_attitude)) out.put(sweep.orientation);
        if (!(same & goes_on)) out.put(sweep.from);
        out.put(sweep.to);
        last = &sweep;
    }
}

std::vector<CutterSweep> get_sweeps(Reader& in) {
    std::vector<std::shared_ptr<const Cutter>> cutters(in.take_count(16));
    for (auto& cutter : cutters) cutter = get_cutter(in);
    std::vector<CutterSweep> sweeps(in.take_count(25));
    CutterSweep last;
    for (CutterSweep& sweep : sweeps) {
        const auto same = in.take<uint8_t>();
        sweep = {last.cutter, last.to, last.to, last.orientation, earlier_block};
        if (!(same & same_cutter)) {
            const auto number = in.take<uint32_t>();
            in.ok = in.ok && number < cutters.size();
            if (in.ok) sweep.cutter = cutters[number];
        }
        if (!(same & same_attitude)) sweep.orientation = in.matrix();
        if (!(same & goes_on)) sweep.from = in.vector();
        sweep.to = in.vector();
        in.ok = in.ok && sweep.cutter && distortion(sweep.orientation) < 1e-9;
        if (!in.ok) return {};
        last = sweep;
    }
    return sweeps;
}

/// The axis and sign of a direction; empty if it is not along an axis.
std::optional<std::pair<int, bool>> along_axis(const Vec3& direction) {
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(std::abs(direction[axis]) - 1.0) < 1e-12)
            return std::pair(axis, direction[axis] > 0.0);
    return std::nullopt;
}

Result<Solid> moved(const Solid& solid, const Transform& by) {
    Solid result{.tolerance = solid.tolerance, .deviation = solid.deviation};
    if (const auto* cylinder = std::get_if<SolidCylinder>(&solid.shape)) {
        Vec3 up(0.0);
        up[cylinder->axis] = 1.0;
        const auto axis = along_axis(by.rotation * up);
        if (!axis)
            return fail(ErrorCode::unsupported,
                        "round stock can only be rotated so that it is parallel to X, Y or Z");
        Vec3 base = by * cylinder->base;
        if (!axis->second) base[axis->first] -= cylinder->height;
        result.shape = SolidCylinder{base, cylinder->radius, cylinder->height, axis->first};
        return result;
    }
    const auto* box = std::get_if<SolidBox>(&solid.shape);
    if (box && along_axis(by.rotation[0]) && along_axis(by.rotation[1])) {
        Aabb turned;
        turned.extend(by * box->box.min);
        turned.extend(by * box->box.max);
        result.shape = SolidBox{turned};
        return result;
    }
    Mesh mesh = box ? mesh_of(box->box) : *std::get<SolidMesh>(solid.shape).mesh;
    for (Vec3& v : mesh.vertices) v = by * v;
    result.shape = solid_mesh(std::move(mesh));
    return result;
}

} // namespace

StockRecord record_of(const CutModel& stock, double path_error) {
    StockRecord record{stock.solid, stock.lines.grid.spacing, {}};
    record.sweeps.reserve(stock.log.size());
    for (size_t i = 0; i < stock.log.size(); ++i) record.sweeps.push_back(stock.log[i].sweep);
    if (path_error == 0.0) return record;
    std::map<std::shared_ptr<const Cutter>, std::shared_ptr<const Cutter>> uncertain;
    for (CutterSweep& sweep : record.sweeps) {
        if (sweep.block == earlier_block) continue; // its record has counted it
        auto& cutter = uncertain[sweep.cutter];
        if (!cutter)
            cutter = std::make_shared<const Cutter>(
                make_cutter(sweep.cutter->cutting, sweep.cutter->path_error + path_error));
        sweep.cutter = cutter;
    }
    return record;
}

std::string bytes_of(const StockRecord& record) {
    ByteWriter out(magic);
    out.put(record.spacing);
    put_solid(out, record.solid);
    put_sweeps(out, record.sweeps);
    out.put(digest_of(out.bytes));
    return std::move(out.bytes);
}

Result<StockRecord> stock_record(const std::string& bytes) {
    const std::string_view all = bytes;
    if (all.substr(0, magic.size()) != magic)
        return fail(ErrorCode::syntax, "is not a stock file saved by Feeler");
    constexpr size_t tail = sizeof(uint64_t);
    const Error damaged{
        ErrorCode::syntax, {}, "is damaged: truncated or changed since it was saved"};
    if (all.size() < magic.size() + tail) return tl::unexpected(damaged);
    Reader end(all.substr(all.size() - tail));
    if (end.take<uint64_t>() != digest_of(all.substr(0, all.size() - tail)))
        return tl::unexpected(damaged);
    Reader in(all.substr(magic.size(), all.size() - magic.size() - tail));
    StockRecord record;
    record.spacing = in.number();
    record.solid = get_solid(in);
    if (in.ok) record.sweeps = get_sweeps(in);
    if (!in.ok || !in.is_at_end() || !(record.spacing > 0.0)) return tl::unexpected(damaged);
    return record;
}

Result<StockRecord> moved(StockRecord record, const Transform& target_from_record) {
    if (target_from_record == Transform()) return record;
    FEELER_TRY(record.solid, moved(record.solid, target_from_record));
    for (CutterSweep& sweep : record.sweeps) {
        sweep.from = target_from_record * sweep.from;
        sweep.to = target_from_record * sweep.to;
        sweep.orientation = target_from_record.rotation * sweep.orientation;
    }
    return record;
}

} // namespace core
