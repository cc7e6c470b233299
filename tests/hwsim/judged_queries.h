#pragma once

#include "core/dbm/cut_model.h"
#include "core/distance/stock_distance.h"
#include "hwsim/search.h"
#include "hwsim/stock_model.h"
#include "hwsim/tool_model.h"
#include "tests/support/stock_oracle.h"

namespace hwsim {

/// What became of many random questions, asked of the device and of the exact engine.
struct JudgedQueries {
    long asked = 0;
    long violations = 0; // by the exact engine: matter nearer than the allowance
    long missed = 0;     // of these, permitted by the device
    long refused = 0;
    long false_alarms = 0; // refused although the exact lower bound keeps the allowance
    long at_a_tie = 0;     // the exact distance is the allowance, but for 1e-6 mm
    std::string first_missed;
};

/// How the questions are made.
struct QueryKind {
    double grid = 0.0; // mm: places, sizes and allowances are multiples of it; 0: anything
    double h = 0.5;
    int stocks = 10, queries = 100; // of each
};

/// A question: a body of revolution on a straight way, and what it must keep.
struct Question {
    core::RevolvedProfile body;
    core::Vec3 from, to;
    double allowance = 0.0;
    uint8_t log2_steps = 0;
};

inline double on_grid(double x, double grid) {
    return grid > 0.0 ? std::round(x / grid) * grid : x;
}

inline Question random_question(std::mt19937& rng, const core::Aabb& box, double grid) {
    const auto any = [&](double a, double b) {
        return on_grid(std::uniform_real_distribution<double>(a, b)(rng), grid);
    };
    Question q;
    const double r = any(0.0, 6.0), lower = any(-1.0, 2.0), height = any(0.0, 12.0);
    switch (rng() % 4) {
    case 0:
        q.body.elements = {{lower, r, lower + height, r, 0.0}};
        break;
    case 1:
        q.body.elements = {{lower, r, lower, r, any(0.0, 3.0)}};
        break;
    case 2:
        q.body.elements = {{lower, r, lower + height, any(0.0, 6.0), any(0.0, 1.0)}};
        break;
    default:
        q.body.elements = {
            {lower, r, lower + height, r, 0.0},
            {lower + height, any(0.0, 9.0), lower + height + 3.0, any(0.0, 9.0), 0.0}};
    }
    const auto position = [&] {
        return core::Vec3(any(box.min.x - 9.0, box.max.x + 9.0),
                          any(box.min.y - 9.0, box.max.y + 9.0), any(box.min.z, box.max.z + 6.0));
    };
    q.from = position();
    q.to = rng() % 3 == 0 ? q.from : position();
    for (int axis = 0; axis < 3; ++axis)
        if (rng() % 2 == 0) q.to[axis] = q.from[axis];
    q.allowance = rng() % 5 == 0 ? 0.0 : any(0.0, 3.0);
    q.log2_steps = static_cast<uint8_t>(rng() % 10);
    return q;
}

/// The stock in a device's memory, with room for a tool.
struct DeviceStock {
    std::vector<Line> memory = std::vector<Line>(20'000);
    LineSpace space{.next = 0, .end = 20'000};
    StockModel model;

    explicit DeviceStock(const core::CutModel& stock) : model(stock_model(cells_of(stock))) {
        const StockUpdate done = update(model, space, stock.columns).value();
        for (const AddressedLine& line : done.lines) memory[line.address] = line.line;
    }

    Answer ask(const Question& q) {
        ModelWriter writer{.space = &space, .side = Side::tool, .epoch = 0};
        const Branch root = add_tree(writer, cylinders_round(q.body, 0.05).value(), 1).value();
        Query query{.tool_header = add_header(writer, root).value(),
                    .work_header = *model.header,
                    .work_epoch = model.epoch};
        for (const AddressedLine& line : writer.lines) memory[line.address] = line.line;
        for (size_t axis = 0; axis < 3; ++axis) {
            const auto i = static_cast<int>(axis);
            query.segment.start[axis] = fixed(q.from[i], Rounding::nearest).value();
            query.segment.end[axis] = fixed(q.to[i], Rounding::nearest).value();
        }
        query.segment.log2_steps = q.log2_steps;
        const double step = glm::length(q.to - q.from) / static_cast<double>(1U << q.log2_steps);
        query.segment.threshold = threshold(q.allowance, step).value();
        query.limit = limit_of(query.segment);
        const Answer answer = search(memory, query);
        for (const LineRun& run : writer.runs) give_back(space, run);
        return answer;
    }
    bool refuses(const Question& q) {
        const Answer answer = ask(q);
        return answer.stop != Stop::none || answer.found;
    }
};

inline core::StockSeparation exact_distance(const Question& q, const core::CutModel& stock) {
    const std::array<core::Vec3, 2> positions{q.from, q.to};
    std::vector<core::ConvexShape> shapes;
    for (const core::ProfileElement& element : q.body.elements)
        shapes.push_back(swept(core::convex(element), positions));
    return separation(shapes, stock,
                      {.limit = q.allowance + 1.0, .threshold = q.allowance, .work_limit = 500});
}

inline void judge(JudgedQueries& all, const Question& q, const core::CutModel& stock,
                  bool refuses) {
    const core::Separation exact = exact_distance(q, stock).separation;
    const bool violates = exact.upper < q.allowance || exact.upper == 0.0;
    ++all.asked;
    all.violations += violates ? 1 : 0;
    all.refused += refuses ? 1 : 0;
    all.at_a_tie += std::abs(exact.upper - q.allowance) < 1e-6 ? 1 : 0;
    all.false_alarms += refuses && exact.lower >= q.allowance && exact.lower > 0.0 ? 1 : 0;
    if (!violates || refuses) return;
    if (all.missed++ == 0)
        all.first_missed = "question " + std::to_string(all.asked) + ", at "
                           + std::to_string(exact.upper) + " of " + std::to_string(q.allowance);
}

/// Asks a device that is made from each stock, and says whether it refuses a question.
template <typename Device>
JudgedQueries judged_queries_of(uint32_t seed, const QueryKind& kind) {
    std::mt19937 rng(seed);
    JudgedQueries all;
    for (int i = 0; i < kind.stocks; ++i) {
        const test_support::CutBox world = test_support::random_cut_box(rng, rng() % 5, 0.0);
        const core::CutModel stock = world.model(kind.h);
        Device device(stock);
        for (int k = 0; k < kind.queries; ++k) {
            const Question q = random_question(rng, world.box, kind.grid);
            judge(all, q, stock, device.refuses(q));
        }
    }
    return all;
}

inline JudgedQueries judged_queries(uint32_t seed, const QueryKind& kind) {
    return judged_queries_of<DeviceStock>(seed, kind);
}

} // namespace hwsim
