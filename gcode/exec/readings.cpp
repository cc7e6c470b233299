#include "gcode/exec/readings.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/rule_table.h"
#include "gcode/exec/fanuc_parameters.h"
#include "gcode/exec/klartext_parameters.h"
#include "gcode/exec/program_parameters.h"
#include "gcode/language/block.h"
#include "gcode/language/control.h"
#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"

namespace gcode {
namespace {

template <typename T>
bool is_same_in(const std::map<std::string, T>& a, const std::map<std::string, T>& b,
                const std::string& key) {
    const auto found = a.find(key), other = b.find(key);
    if (found == a.end() || other == b.end()) return found == a.end() && other == b.end();
    return found->second == other->second;
}

const OpenPremise* find_met(const Readings& readings, const PremiseId& id) {
    const auto found = std::find_if(readings.met.begin(), readings.met.end(),
                                    [&](const OpenPremise& premise) { return premise.id == id; });
    return found == readings.met.end() ? nullptr : &*found;
}

/// Records a premise, with the reading chosen for this run.
size_t take_reading(InterpreterState& state, OpenPremise premise) {
    Readings& readings = state.readings.write();
    const auto chosen = readings.chosen.find(premise.id);
    premise.is_chosen = chosen != readings.chosen.end();
    premise.taken = premise.is_chosen ? chosen->second : 0;
    readings.met.push_back(std::move(premise));
    return readings.met.back().taken;
}

std::string number_text(const ParameterValue& value) {
    return value.word.empty() ? fmt::format("{:g}", value.number) : std::string(value.word);
}

Reading reading_of(const ControlParameter& parameter, const ParameterValue& value) {
    if (parameter.key.empty()) return {std::string(value.text), {}};
    // A length is its own explanation.
    if (parameter.values.size() == 1)
        return {fmt::format("{} is {}", parameter.name, value.text), {}};
    return {fmt::format("{} is {}", parameter.name, number_text(value)), std::string(value.text)};
}

/// Whether a question is about a mode at the start that an earlier program may have left.
bool is_start_mode(ControlQuestion question) {
    using enum ControlQuestion;
    return question == starts_incremental || question == starts_with_feed
           || question == starts_in_plane || question == starts_in_yz;
}

std::string cure_of(const ControlParameter& parameter, const Environment& environment) {
    if (!parameter.statement.empty()) return std::string(parameter.statement);
    // What stays from an earlier program can only be programmed.
    if (is_start_mode(parameter.question)
        && environment.control.answer(ControlQuestion::modes_are_initial) == false)
        return fmt::format("Program {} before the first move.",
                           parameter.question == ControlQuestion::starts_incremental ? "G90"
                           : parameter.question == ControlQuestion::starts_with_feed ? "G0 or G1"
                                                                                     : "G17");
    if (parameter.question == ControlQuestion::starts_in_inches)
        return fmt::format(
            "Program {} at the beginning, or state \"{}\" = {} under [control] in the "
            "set-up.",
            environment.dialect == DialectId::siemens ? "G71 or G70" : "G21 or G20", parameter.key,
            parameter.choices());
    return fmt::format("State \"{}\" = {} under [control] in the set-up.", parameter.key,
                       parameter.choices());
}

/// What is stated. Where the control keeps the modes of the program before, the initial ones say
/// nothing; where it restores them and no parameter chooses them, they are the first ones.
std::optional<double> stated_number(const Environment& environment, ControlQuestion question) {
    const ControlSettings& control = environment.control;
    if (!is_start_mode(question)) return control.number(question);
    const auto restores = control.answer(ControlQuestion::modes_are_initial);
    if (restores == false) return std::nullopt;
    const ControlParameter* parameter = find_parameter(question, environment.dialect);
    if (restores && parameter && parameter->key.empty()) return parameter->values[0].answer;
    return control.number(question);
}

/// Whether a parameter that is not stated is a premise of a run.
bool is_premise(const Environment& environment, const ControlParameter& parameter) {
    return environment.control.reports_premises && parameter.if_not_stated != IfNotStated::go_on;
}

} // namespace

bool Facts::agree_on(const std::string& identity, const Facts& other) const {
    return is_same_in(possible, other.possible, identity)
           && is_same_in(answers, other.answers, identity);
}

void Facts::forget(std::string_view part) {
    const auto contains = [&](const auto& fact) {
        return fact.first.find(part) != std::string::npos;
    };
    std::erase_if(possible, contains);
    std::erase_if(answers, contains);
}

OpenPremise premise_of(const ControlParameter& parameter, const Environment& environment) {
    const std::span<const ParameterValue> values = parameter.values;
    OpenPremise premise;
    premise.id = {parameter.question};
    premise.reason = fmt::format("The set-up does not state {}", parameter.name);
    premise.cure = cure_of(parameter, environment);
    std::set<double> answers; // several values may have the same
    for (const ParameterValue& value : parameter.is_open() ? values : values.first(1))
        if (answers.insert(value.answer).second)
            premise.readings.push_back(reading_of(parameter, value));
    return premise;
}

bool is_open(const InterpreterState& state, const Environment& environment,
             ControlQuestion question) {
    if (!environment.control.reports_premises || stated_number(environment, question)) return false;
    const ControlParameter* parameter = find_parameter(question, environment.dialect);
    return parameter && parameter->is_open() && !find_met(*state.readings, {question});
}

namespace {

/// Whether the initial value of a mode is stated, but not that the control restores it.
bool may_be_left(const Environment& environment, ControlQuestion question) {
    constexpr ControlQuestion restores = ControlQuestion::modes_are_initial;
    const ControlSettings& control = environment.control;
    return control.reports_premises && is_start_mode(question) && control.number(question)
           && !control.number(restores) && find_parameter(restores, environment.dialect);
}

/// The answer other than that number.
double other_answer(const ControlParameter& parameter, double number) {
    for (const ParameterValue& value : parameter.values)
        if (value.answer != number) return value.answer;
    return number;
}

/// As number_for, for one of several switches that have the same parameter: `which`, 0 if there is
/// only one.
double answer_under(InterpreterState& state, const Environment& environment,
                    ControlQuestion question, uint32_t which, uint32_t line) {
    if (may_be_left(environment, question)
        && answer_under(state, environment, ControlQuestion::modes_are_initial, 0, line) == 0.0)
        return other_answer(*find_parameter(question, environment.dialect),
                            *environment.control.number(question));
    if (const auto stated = stated_number(environment, question)) return *stated;
    const ControlParameter* parameter = find_parameter(question, environment.dialect);
    if (!parameter || parameter->values.empty()) return 0.0;
    const std::span<const ParameterValue> values = parameter->values;
    if (!is_premise(environment, *parameter)) return values[0].answer;
    const PremiseId id{question, {}, which};
    const OpenPremise* met = find_met(*state.readings, id);
    if (met) return values[met->taken].answer;
    OpenPremise premise = premise_of(*parameter, environment);
    premise.id = id;
    premise.line = line;
    for (Reading& reading : premise.readings)
        if (const size_t slash = reading.when.find("/ "); which > 0 && slash != std::string::npos)
            reading.when.insert(slash + 1, std::to_string(which));
    return values[take_reading(state, std::move(premise))].answer;
}

} // namespace

double number_for(InterpreterState& state, const Environment& environment, ControlQuestion question,
                  uint32_t line) {
    return answer_under(state, environment, question, 0, line);
}

double current_number(const InterpreterState& state, const Environment& environment,
                      ControlQuestion question) {
    if (const auto stated = stated_number(environment, question)) return *stated;
    const ControlParameter* parameter = find_parameter(question, environment.dialect);
    if (!parameter || parameter->values.empty()) return 0.0;
    const OpenPremise* met = find_met(*state.readings, {question});
    return parameter->values[met ? met->taken : 0].answer;
}

LengthUnit first_unit(InterpreterState& state, const Environment& environment, uint32_t line) {
    const bool is_known =
        dialect(environment.dialect).unit_is_machines && environment.machine_unit_is_stated;
    constexpr ControlQuestion question = ControlQuestion::starts_in_inches;
    if (is_known || !environment.control.follows_start
        || !find_parameter(question, environment.dialect))
        return state.modal.unit;
    return answer_to(state, environment, question, line) ? LengthUnit::inch : LengthUnit::mm;
}

bool keeps_modes(const Environment& environment) {
    const ControlParameter* distance =
        find_parameter(ControlQuestion::starts_incremental, environment.dialect);
    const auto restores = environment.control.answer(ControlQuestion::modes_are_initial);
    return restores ? !*restores : distance && distance->key.empty();
}

bool may_keep_modes(const Environment& environment) {
    constexpr ControlQuestion restores = ControlQuestion::modes_are_initial;
    const bool is_open = environment.control.reports_premises && environment.control.follows_start
                         && !environment.control.number(restores)
                         && find_parameter(restores, environment.dialect);
    return is_open || keeps_modes(environment);
}

bool starts_with_left_modes(InterpreterState& state, const Environment& environment,
                            uint32_t line) {
    if (keeps_modes(environment)) return true;
    return may_keep_modes(environment)
           && number_for(state, environment, ControlQuestion::modes_are_initial, line) == 0.0;
}

namespace {

/// The work offsets that may be active at the start: G54, and the others that are stated. Without a
/// set-up, all are assumed to be equal.
std::vector<size_t> possible_offsets(const Environment& environment) {
    std::vector<size_t> found = {0};
    if (!environment.control.follows_start) return found;
    for (size_t index = 1; index < plain_offset_count; ++index)
        if (environment.work_offsets[index] != AxisValues{}) found.push_back(index);
    for (const auto& [index, origin] : environment.extended_offsets) found.push_back(index);
    return found;
}

std::string offset_code(size_t index) {
    if (index < 6) return fmt::format("G{}", 54 + index);
    if (index < plain_offset_count) return fmt::format("G59.{}", index - 5);
    return fmt::format("G54.1 P{}", index - plain_offset_count + 1);
}

} // namespace

bool may_start_elsewhere(const Environment& environment) {
    return may_keep_modes(environment) && possible_offsets(environment).size() > 1;
}

size_t first_work_offset(InterpreterState& state, const Environment& environment, uint32_t line) {
    const std::vector<size_t> offsets = possible_offsets(environment);
    const PremiseId id{ControlQuestion::starts_with_offset};
    if (!environment.control.reports_premises) return offsets[0];
    if (const OpenPremise* met = find_met(*state.readings, id)) return offsets[met->taken];
    OpenPremise premise;
    premise.id = id;
    premise.line = line;
    premise.reason = "The work offset that an earlier program left is not known";
    premise.cure = "Program G54 or another work offset before the first move.";
    for (const size_t index : offsets)
        premise.readings.push_back(
            {fmt::format("{} is active at the start", offset_code(index)), {}});
    return offsets[take_reading(state, std::move(premise))];
}

bool deletes_blocks(InterpreterState& state, const Environment& environment, int number,
                    uint32_t line) {
    const BlockDelete switches = dialect(environment.dialect).block_delete;
    if (switches == BlockDelete::none) return false;
    const bool is_first =
        switches == BlockDelete::one_switch || number == number_of_plain_slash(switches);
    const uint32_t which = is_first ? 0 : static_cast<uint32_t>(number);
    return environment.block_delete
           || answer_under(state, environment, ControlQuestion::blocks_are_deleted, which, line)
                  != 0.0;
}

bool answer_to(InterpreterState& state, const Environment& environment, ControlQuestion question,
               uint32_t line) {
    return number_for(state, environment, question, line) != 0.0;
}

namespace {

/// How often one condition is followed; more than the readings that a check follows.
constexpr uint32_t most_occurrences = 100;

/// A condition that depends on what only the machine knows.
struct OpenCondition {
    const Block& block;
    std::string reason;
    std::string cure;
    bool computed; // its outcome with the usual values
    Trace trace{no_identity, false, std::nullopt};
    double equality = 0.0;
    std::vector<std::string> reads{}; // the unknown variables

    bool varies() const { return trace.identity == no_identity; }
};

PossibleValues values_of(const Facts& facts, const std::string& identity,
                         const Environment& environment) {
    const auto known = facts.possible.find(identity);
    return known != facts.possible.end()
               ? known->second
               : PossibleValues(dialect(environment.dialect).unset_is_vacant);
}

/// The key under which facts about a condition are kept.
const std::string& subject_of(const OpenCondition& condition) {
    const auto& comparison = condition.trace.comparison;
    return comparison ? comparison->identity : condition.trace.identity;
}

/// The outcome that follows from earlier conditions of the run; empty if both are possible.
std::optional<bool> settled_outcome(const Facts& facts, const Environment& environment,
                                    const OpenCondition& condition) {
    if (condition.varies()) return std::nullopt;
    if (const auto& comparison = condition.trace.comparison) {
        const PossibleValues values = values_of(facts, comparison->identity, environment);
        const bool can_hold = !values.where(*comparison, condition.equality, true).is_empty();
        const bool can_fail = !values.where(*comparison, condition.equality, false).is_empty();
        return can_hold != can_fail ? std::optional(can_hold) : std::nullopt;
    }
    const auto known = facts.answers.find(condition.trace.identity);
    if (known == facts.answers.end()) return std::nullopt;
    return known->second != condition.trace.is_negated;
}

void keep_outcome(Facts& facts, const Environment& environment, const OpenCondition& condition,
                  bool outcome) {
    if (condition.varies()) return;
    if (const auto& comparison = condition.trace.comparison)
        facts.possible.insert_or_assign(comparison->identity,
                                        values_of(facts, comparison->identity, environment)
                                            .where(*comparison, condition.equality, outcome));
    else
        facts.answers.insert_or_assign(condition.trace.identity,
                                       outcome != condition.trace.is_negated);
}

/// Whether a condition that was settled has been met twice again in the same state: the program
/// waits here for ever. At the first return, another condition of the loop may still end it. States
/// are compared with those after 1, 2, 4 ... passes, so that a long loop costs no memory.
bool comes_back_to(Readings& readings, const ProgramLine& line, uint64_t digest) {
    Passed& passed = readings.passed[line];
    if (passed.count > 0 && passed.state_digest == digest) return ++passed.returns > 1;
    if (!std::has_single_bit(++passed.count)) return false;
    passed.state_digest = digest;
    passed.returns = 0;
    return false;
}

/// The program waits until something outside changes the values that a condition reads.
void renew_reads(InterpreterState& state, const Environment& environment,
                 const OpenCondition& condition) {
    if (condition.varies()) return;
    ProgramParameters parameters(state, environment);
    for (const std::string& name : condition.reads) parameters.renew(name);
}

bool outcome_of(InterpreterState& state, const Environment& environment,
                const OpenCondition& condition) {
    const Block& block = condition.block;
    const bool computed = condition.computed;
    const Readings& readings = *state.readings;
    const ProgramLine here{state.next.source, block.line};
    if (const auto settled = settled_outcome(readings.facts, environment, condition)) {
        const uint64_t digest = digest_of(state);
        Readings& written = state.readings.write();
        written.repeated.insert(subject_of(condition));
        if (comes_back_to(written, here, digest)) {
            renew_reads(state, environment, condition);
            return !*settled;
        }
        return *settled;
    }
    OpenPremise premise;
    premise.line = block.line;
    premise.id.line = here;
    premise.state_digest = digest_of(state);
    for (const OpenPremise& earlier : readings.met) {
        if (earlier.id.question || earlier.id.line != premise.id.line) continue;
        // That outcome leads back to the same state: the program waits here. A loop that changes
        // the state is left after as many passes as a check can follow.
        if (earlier.state_digest == premise.state_digest
            || premise.id.occurrence == most_occurrences) {
            const bool outcome = !earlier.outcome;
            renew_reads(state, environment, condition);
            return outcome;
        }
        ++premise.id.occurrence;
    }
    for (const bool outcome : {computed, !computed})
        premise.readings.push_back({fmt::format("the condition in line {} {}", block.line,
                                                outcome ? "holds" : "does not hold"),
                                    {}});
    premise.reason = condition.reason;
    premise.cure = condition.cure;
    const size_t taken = take_reading(state, std::move(premise));
    const bool outcome = taken == 0 ? computed : !computed;
    Readings& written = state.readings.write();
    written.met.back().outcome = outcome;
    keep_outcome(written.facts, environment, condition, outcome);
    return outcome;
}

/// Only an earlier program can have set a global variable of LinuxCNC that the program asks for.
std::string how_to_state(const std::vector<std::string>& names) {
    std::vector<std::string> values;
    for (const std::string& name : names)
        values.push_back(name + (name.starts_with("#<_") ? ", or \"unset\"," : ""));
    return fmt::format("State the value{} of {} under [program.values] in the set-up.",
                       names.size() > 1 ? "s" : "", fmt::join(values, " and "));
}

} // namespace

bool outcome_of(const ProgramParameters& parameters, const Block& block, Expression condition,
                const Arithmetic& arithmetic, bool computed) {
    const auto& reads = parameters.unpredictable_reads();
    if (reads.empty()) return computed;
    OpenCondition open{block,
                       fmt::format("The condition depends on {}, which the program does not set",
                                   fmt::join(reads, " and ")),
                       how_to_state(reads), computed};
    open.equality = arithmetic.equality;
    open.reads = reads;
    const ProgramParameters again(parameters.state(), parameters.environment());
    Trace trace;
    if (evaluate(block.pool, condition, block.line, again, arithmetic, nullptr, &trace)
        && !trace.identity.empty() && !parameters.reads_vary())
        open.trace = std::move(trace);
    return outcome_of(parameters.state(), parameters.environment(), open);
}

bool outcome_of_input(InterpreterState& state, const Environment& environment, const Block& block,
                      const std::string& what, bool computed) {
    if (!environment.control.reports_premises) return computed;
    return outcome_of(state, environment,
                      {block, fmt::format("The path depends on {}", what),
                       "Change the program so that both ways are safe.", computed});
}

std::string cause_of_number(const ProgramParameters& parameters) {
    const auto& reads = parameters.unpredictable_reads();
    if (reads.empty()) return {};
    return fmt::format(
        ": the number depends on {}, which the program does not set; state its value "
        "under [program.values] in the set-up",
        fmt::join(reads, " and "));
}

void report_unknown(const ProgramParameters& parameters, BlockCommands& result,
                    core::SourceSpan where, std::string_view what) {
    for (const std::string& name : parameters.unpredictable_reads()) {
        if (!parameters.state().readings.write().reported.insert(name).second) continue;
        result.warnings.push_back(
            {Severity::warning, where,
             fmt::format(
                 "{} depends on {}, which only the machine knows here: the program does not "
                 "set it before",
                 what, name),
             core::rule_id("unknown-value"), how_to_state({name})});
    }
}

namespace {

bool is_in(int number, int first, int last) { return number >= first && number <= last; }

Knowledge knowledge_of_macro_variable(const Environment& environment, bool is_haas, int number) {
    if (is_in(number, 100, 149)) {
        const auto kept = environment.control.answer(ControlQuestion::variables_are_kept);
        return kept == false ? Knowledge::known : Knowledge::unknown_until_set;
    }
    if (is_in(number, 150, 999)) return Knowledge::unknown_until_set;
    if (is_in(number, 1000, 1099)) return Knowledge::unknown;
    if (is_in(number, 1100, 1199) || is_in(number, 3901, 3902)) return Knowledge::unknown_until_set;
    // The whole offset in memory A, otherwise its wear.
    const bool is_wear_or_offset = is_in(number, 2001, 2200) || is_in(number, 10001, 10999);
    if (!is_haas && is_wear_or_offset
        && !environment.control.number(ControlQuestion::offset_memory))
        return Knowledge::unknown_until_set;
    if (number == 3011 || number == 3012) return Knowledge::unknown;
    if (is_in(number, 5061, 5069)) return Knowledge::unknown; // where the last G31 stopped
    if (is_haas && is_in(number, 10000, 10999)) return Knowledge::unknown_until_set;
    if (number >= 1000 && !is_modelled_variable(environment, number)) return Knowledge::unknown;
    return Knowledge::known;
}

Knowledge knowledge_of_linuxcnc_parameter(int number) {
    if (is_in(number, 31, 5000)) return Knowledge::unknown_until_set;
    if (is_in(number, 5061, 5070) || number == 5399) return Knowledge::unknown_once_set;
    return Knowledge::known;
}

} // namespace

Knowledge knowledge_of(const Environment& environment, int number) {
    const Dialect& rules = dialect(environment.dialect);
    if (rules.language == Language::klartext)
        return is_in(number, 100, 199) ? knowledge_of_preassigned(number)
                                       : Knowledge::unknown_until_set;
    switch (rules.system_parameters) {
    case SystemParameters::fanuc:
        return knowledge_of_macro_variable(environment, false, number);
    case SystemParameters::haas:
        return knowledge_of_macro_variable(environment, true, number);
    case SystemParameters::siemens:
        return Knowledge::unknown_until_set;
    default:
        return knowledge_of_linuxcnc_parameter(number);
    }
}

} // namespace gcode
