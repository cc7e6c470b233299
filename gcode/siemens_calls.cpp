#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "gcode/lexer.h"
#include "gcode/parser.h"
#include "gcode/siemens_flow.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// NAME of NAME, NAME.SPF, `/_N_SPF_DIR/_N_NAME_SPF`, in capitals.
std::string plain_name(const std::string& written) {
    std::string name = written.substr(written.find_last_of("/\\:") + 1);
    std::transform(name.begin(), name.end(), name.begin(), upper);
    if (name.starts_with("_N_")) name.erase(0, 3);
    for (const std::string_view ending : {"_SPF", "_MPF", ".SPF", ".MPF"})
        if (name.ends_with(ending)) {
            name.resize(name.size() - ending.size());
            break;
        }
    return name;
}

std::optional<Place> place_in(ProgramLibrary& library, uint32_t source, const std::string& name) {
    const FlowMark* mark = library.index(source).first(FlowKind::program_number, name);
    return mark ? std::optional(Place{source, mark->line + 1}) : std::nullopt;
}

/// Where a program begins: behind its header in this file or the main one, else in a file of the
/// search path.
core::Result<Place> place_of_program(const FlowStep& step, const std::string& name) {
    if (const auto own = place_in(step.library, step.state.next.source, name)) return *own;
    if (const auto main = place_in(step.library, 0, name)) return *main;
    std::vector<std::string> names;
    for (const std::string_view ending : {".SPF", ".MPF"}) names.push_back(name + ending.data());
    for (const std::string_view ending : {"_SPF", "_MPF"})
        names.push_back("_N_" + name + ending.data());
    FEELER_TRY(const auto source, step.library.find_in_any_case(names));
    if (source) return Place{*source, 1};
    const auto& path = step.library.search_path();
    return core::fail(ErrorCode::syntax,
                      fmt::format("'{}' is no word of this control, and there is no program {}.SPF "
                                  "or {}.MPF in {}",
                                  step.block.siemens.name, name, name,
                                  path.empty() ? "a search path, for there is none"
                                               : fmt::format("{}", fmt::join(path, ", "))),
                      step.block.siemens.name_span);
}

/// PROC of a program: the first block that says something.
core::Result<Block> head_of(const FlowStep& step, Place begin) {
    const Program& program = step.library.program(begin.source);
    Block block;
    for (size_t line = begin.line; program.has_line(line).value_or(false); ++line) {
        auto parsed =
            parse_line(program.line(line), static_cast<uint32_t>(line), step.dialect, block);
        if (!parsed) {
            core::Error error = std::move(parsed).error();
            error.file = program.file;
            return tl::unexpected(std::move(error));
        }
        if (!block.is_empty()) return block;
    }
    return Block{};
}

core::Result<void> set_parameters(const FlowStep& step, const Block& head, Frame& frame) {
    const auto& arguments = step.block.siemens.arguments;
    const auto& parameters = head.siemens.declarations;
    const bool is_procedure = head.flow.kind == FlowKind::procedure;
    if (arguments.size() > (is_procedure ? parameters.size() : 0))
        return core::fail(ErrorCode::syntax,
                          fmt::format("{} takes {} parameters, and {} are given", frame.name,
                                      is_procedure ? parameters.size() : 0, arguments.size()),
                          step.block.siemens.name_span);
    if (!is_procedure) return {};
    const FlowStep at_head{step.library, step.environment, step.dialect,
                           head,         step.state,       step.result};
    for (size_t i = 0; i < parameters.size(); ++i) {
        const SiemensDeclaration& parameter = parameters[i];
        if (parameter.by_reference)
            return core::fail(ErrorCode::unsupported,
                              fmt::format("{} has the parameter VAR {}, which gives a value back: "
                                          "that is not supported yet; use an R parameter",
                                          frame.name, parameter.name),
                              step.block.siemens.name_span);
        const bool given =
            i < arguments.size() && arguments[i].kind != SiemensArgument::Kind::nothing;
        double value = 0.0;
        if (given) {
            FEELER_TRY(value, value_of_argument(step, arguments[i]));
        } else if (parameter.initial.kind != SiemensArgument::Kind::nothing) {
            FEELER_TRY(value, value_of_argument(at_head, parameter.initial));
        }
        frame.named[parameter.name] = held_as(parameter.type, value);
        if (parameter.type != SiemensType::real) frame.types[parameter.name] = parameter.type;
    }
    return {};
}

core::Result<int64_t> rounds_of(const FlowStep& step) {
    const SiemensArgument& repeats = step.block.siemens.repeats;
    if (repeats.kind == SiemensArgument::Kind::nothing) return 1;
    FEELER_TRY(const double rounds, value_of_argument(step, repeats));
    if (rounds >= 0.0 && rounds <= 9999.0 && rounds == std::floor(rounds))
        return static_cast<int64_t>(rounds);
    return core::fail(ErrorCode::invalid_value,
                      fmt::format("P{:.12g}: a call is made from 0 to 9999 times", rounds),
                      repeats.span);
}

} // namespace

core::Result<Frame> called_frame(const FlowStep& step) {
    const std::string name = plain_name(step.block.siemens.name);
    FEELER_TRY(const Place begin, place_of_program(step, name));
    Frame frame{
        .called_from = {step.state.next.source, step.block.line}, .begin = begin, .name = name};
    FEELER_TRY(const Block head, head_of(step, begin));
    if (auto set = set_parameters(step, head, frame); !set)
        return tl::unexpected(std::move(set).error());
    if (head.siemens.saves_modes) {
        frame.restores = true;
        frame.saved.write() = step.state.modal;
    }
    FEELER_TRY(const int64_t rounds, rounds_of(step));
    frame.rounds_left = rounds - 1;
    return frame;
}

core::Result<void> call_siemens_program(const FlowStep& step) {
    FEELER_TRY(Frame frame, called_frame(step));
    if (frame.rounds_left < 0) return {};
    return enter(step.state, step.environment, std::move(frame), step.block.siemens.name_span);
}

core::Result<void> declare_variables(const FlowStep& step) {
    std::vector<double> values;
    for (const SiemensDeclaration& entry : step.block.siemens.declarations) {
        double value = 0.0;
        if (entry.initial.kind != SiemensArgument::Kind::nothing) {
            FEELER_TRY(value, value_of_argument(step, entry.initial));
        }
        values.push_back(held_as(entry.type, value));
    }
    Frame& frame = step.state.frames.back();
    for (size_t i = 0; i < values.size(); ++i) {
        const SiemensDeclaration& entry = step.block.siemens.declarations[i];
        if (frame.named.size() >= most_named_parameters)
            return core::fail(ErrorCode::invalid_value, "there are too many variables", entry.span);
        frame.named[entry.name] = values[i];
        if (entry.type != SiemensType::real) frame.types[entry.name] = entry.type;
    }
    return {};
}

} // namespace gcode
