#pragma once

#include <random>
#include <vector>

#include "hwsim/registers.h"
#include "hwsim/search.h"
#include "hwsim/stock_model.h"

namespace hwsim {

inline int32_t within(std::mt19937& rng, int32_t reach) {
    return static_cast<int32_t>(rng() % (2 * static_cast<uint32_t>(reach) + 1)) - reach;
}

inline FixedVec random_place(std::mt19937& rng, int32_t reach) {
    return {within(rng, reach), within(rng, reach), within(rng, reach)};
}

/// A record in a cube of half size `reach`; one in three is a bare point.
inline Record random_record(std::mt19937& rng, int32_t reach) {
    Record record{.base = random_place(rng, reach)};
    if (rng() % 3 == 0) return record;
    const uint32_t most = std::min(static_cast<uint32_t>(Record::greatest_extent),
                                   static_cast<uint32_t>(reach) / 2 + 1);
    record.run = static_cast<int32_t>(rng() % most);
    record.half = static_cast<int32_t>(rng() % most);
    return record;
}

inline Segment random_segment(std::mt19937& rng, int32_t reach, uint8_t log2_steps) {
    return {.log2_steps = log2_steps,
            .start = random_place(rng, reach),
            .end = random_place(rng, reach)};
}

/// Two models in a memory, and the query of one against the other.
struct Scene {
    std::vector<Line> memory;
    std::vector<Record> tools, works;
    Query query;
};

inline uint32_t put_model(std::vector<Line>& memory, LineSpace& space, Side side,
                          const std::vector<Record>& records, uint32_t leaf_size,
                          Volumes volumes = Volumes::boxes) {
    ModelWriter writer{.space = &space, .side = side, .volumes = volumes, .epoch = 1};
    Branch root;
    if (!records.empty()) root = add_tree(writer, records, leaf_size).value();
    const uint32_t header = add_header(writer, root).value();
    for (const AddressedLine& line : writer.lines) memory[line.address] = line.line;
    return header;
}

inline Scene scene_of(std::vector<Record> tools, std::vector<Record> works, const Segment& segment,
                      uint64_t limit, uint32_t leaf_size = 8, Volumes volumes = Volumes::boxes) {
    const size_t lines = 2 * (tools.size() + works.size()) + 16;
    Scene scene{.memory = std::vector<Line>(lines), .tools = tools, .works = works};
    LineSpace space{.end = static_cast<uint32_t>(lines)};
    scene.query = {.segment = segment,
                   .tool_header =
                       put_model(scene.memory, space, Side::tool, tools, leaf_size, volumes),
                   .tool_epoch = 1,
                   .work_epoch = 1,
                   .limit = limit};
    scene.query.work_header = put_model(scene.memory, space, Side::work, works, leaf_size, volumes);
    return scene;
}

inline Record record_named(const Scene& scene, uint32_t name) {
    return records_in(scene.memory[name / records_per_line])[name % records_per_line];
}

/// What a scene is made of.
struct SceneKind {
    int32_t reach = 100'000; // of the records
    int32_t grid = 1;        // everything is a multiple of this
    uint32_t most_records = 60;
    bool bare = false; // points only
};

inline Scene random_scene(std::mt19937& rng, const SceneKind& kind) {
    const auto cloud = [&](uint32_t count) {
        std::vector<Record> records;
        for (uint32_t i = 0; i < count; ++i) {
            Record r = random_record(rng, kind.reach / kind.grid);
            if (kind.bare) r.run = r.half = 0;
            for (int32_t& value : r.base) value *= kind.grid;
            r.run *= kind.grid;
            r.half *= kind.grid;
            records.push_back(r);
        }
        return records;
    };
    const std::vector<Record> tools = cloud(1 + rng() % kind.most_records);
    const std::vector<Record> works = cloud(1 + rng() % kind.most_records);
    const int32_t far = (1 + static_cast<int32_t>(rng() % 4)) * kind.reach / kind.grid;
    Segment segment = random_segment(rng, far, static_cast<uint8_t>(rng() % 7));
    if (rng() % 4 == 0) segment.end = segment.start;
    for (size_t axis = 0; axis < 3; ++axis) {
        segment.start[axis] *= kind.grid;
        segment.end[axis] *= kind.grid;
    }
    const auto near = static_cast<uint64_t>(rng() % static_cast<uint32_t>(3 * kind.reach));
    const uint64_t limit = rng() % 2 ? beyond_all_squares : near * near;
    return scene_of(tools, works, segment, limit, 1 + rng() % 16);
}

} // namespace hwsim
