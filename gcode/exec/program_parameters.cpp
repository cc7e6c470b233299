#include "gcode/exec/program_parameters.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/math.h"
#include "gcode/exec/fanuc_parameters.h"
#include "gcode/exec/klartext_parameters.h"
#include "gcode/exec/linuxcnc_parameters.h"
#include "gcode/exec/probing.h"
#include "gcode/exec/readings.h"
#include "gcode/language/block.h"
#include "gcode/language/control.h"
#include "gcode/language/language.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// The number under which a variable is stored: on Haas controls, #10100 is #100.
///
/// Source: Haas, list of system variables: those of the NGC and the legacy ones.
int stored_number(int number, const Dialect& dialect) {
    if (dialect.system_parameters != SystemParameters::haas) return number;
    constexpr std::pair<int, int> aliases[] = {{10100, 10199}, {10500, 10699}, {10800, 10999}};
    for (const auto& [first, last] : aliases)
        if (number >= first && number <= last) return number - 10000;
    return number;
}

/// The number of a parameter. A computed number may be off by a rounding error.
core::Result<int> parameter_number(double number, int lowest, const Dialect& dialect,
                                   core::SourceSpan where) {
    const double whole = core::round(number);
    if (whole == 0.0 && std::abs(number) < 1e-4 && dialect.has_parameter_zero)
        return highest_parameter;
    if (std::abs(number - whole) > 1e-4 || !(whole >= lowest && whole <= highest_parameter))
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format("{}{:.12g}: parameter numbers are whole numbers from {} to {}",
                        dialect.parameter_letter, number, lowest, highest_parameter),
            where);
    return stored_number(static_cast<int>(whole), dialect);
}

bool is_siemens(const Environment& environment) {
    return dialect(environment.dialect).system_parameters == SystemParameters::siemens;
}

bool is_klartext(const Environment& environment) {
    return dialect(environment.dialect).language == Language::klartext;
}

bool is_fanuc(const Environment& environment) {
    return remembers_words(dialect(environment.dialect).system_parameters);
}

} // namespace

ProgramParameters::ProgramParameters(InterpreterState& state, const Environment& environment)
    : state_(state), environment_(environment), dialect_(gcode::dialect(environment.dialect)) {}

/// The call level whose local parameters are used: M98 uses those of its caller.
Frame& ProgramParameters::locals() {
    size_t level = state_.frames.size() - 1;
    while (level > 0 && state_.frames[level].shares_locals) --level;
    return state_.frames[level];
}

const Frame& ProgramParameters::locals() const {
    return const_cast<ProgramParameters*>(this)->locals();
}

bool ProgramParameters::is_global(std::string_view name) const {
    return name.starts_with('_') && !dialect_.names_are_declared;
}

/// Names that begin with `_` are global, others local to the current call level.
const NamedValues& ProgramParameters::named_values(std::string_view name) const {
    return is_global(name) ? state_.parameters->named() : state_.frames.back().named;
}

core::Result<Value> ProgramParameters::numbered(double number, core::SourceSpan where) const {
    FEELER_TRY(const int index,
               parameter_number(number, dialect_.unset_is_vacant ? 0 : 1, dialect_, where));
    identity_.clear();
    if (index == 0) return Value{};
    if (environment_.control.reports_premises) {
        const auto stated = environment_.control.values.find(index);
        if (stated != environment_.control.values.end() && index > dialect_.local_count
            && knowledge_of(environment_, index) != Knowledge::unknown_until_set)
            return Value{stated->second};
        note_read(index, index <= dialect_.local_count);
        if (is_fanuc(environment_) && is_size_of_tool(environment_, index))
            (void)size_factor(state_, environment_, where.line);
    }
    const Value unset = dialect_.unset_is_vacant ? Value{} : Value{0.0};
    if (index <= dialect_.local_count) {
        const Value local = locals().locals[static_cast<size_t>(index)];
        return local ? local : unset;
    }
    if (const auto shown = system_parameter(state_, environment_, index)) return told(*shown);
    const Value value = state_.parameters->numbered(index);
    return value ? value : unset;
}

Value ProgramParameters::told(Value system_value) const {
    if (environment_.on_system_read) environment_.on_system_read(system_value.value_or(0.0));
    return system_value;
}

tl::unexpected<core::Error> ProgramParameters::undeclared(std::string_view name,
                                                          core::SourceSpan where) const {
    const bool system = name.starts_with('$');
    return core::fail(
        ErrorCode::invalid_value,
        fmt::format("'{}': {}", name,
                    system ? "this system variable is not supported; program its value instead"
                           : "this variable is not defined in this program: declare it with DEF "
                             "REAL, or program its value"),
        where);
}

core::Result<Value> ProgramParameters::named(std::string_view name, core::SourceSpan where) const {
    identity_.clear();
    if (const auto shown = system_parameter(state_, environment_, name)) return told(*shown);
    if (environment_.control.reports_premises) note_read(name);
    const NamedValues& all = named_values(name);
    const auto found = all.find(name);
    if (found == all.end() && dialect_.names_are_declared) return undeclared(name, where);
    if (found == all.end() && may_be_left(name)) return Value{0.0};
    if (found == all.end() && name.starts_with("_hal["))
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("#<{0}> is a value of the machine: give its ini file, or "
                                      "state \"#<{0}>\" under [program.values] in the set-up",
                                      name),
                          where);
    if (found == all.end())
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("#<{}> is used before it is set", name), where);
    return Value{found->second};
}

/// Whether the program asked if a variable exists that only an earlier program can have set. In the
/// reading in which it does, its value is unknown.
bool ProgramParameters::may_be_left(std::string_view name) const {
    const auto& marked = state_.parameters->unpredictable_names();
    return is_global(name) && marked.find(name) != marked.end();
}

bool ProgramParameters::exists(std::string_view name) const {
    identity_.clear();
    const NamedValues& all = named_values(name);
    if (all.find(name) != all.end() || system_parameter(state_, environment_, name)) return true;
    // A pin of a machine whose ini file is given exists, whether or not its value is known.
    if (name.starts_with("_hal[") && !environment_.hal_values.empty()) return true;
    const auto& stated = environment_.control.named_values;
    if (!environment_.control.reports_premises || !is_global(name)
        || stated.find(name) != stated.end())
        return false;
    note_unpredictable(shown_name(name), "exists " + shown_name(name));
    if (!may_be_left(name)) state_.parameters.write().mark(name, true);
    return false;
}

core::Result<void> ProgramParameters::set_numbered(double number, Value value,
                                                   core::SourceSpan where) {
    FEELER_TRY(const int index, parameter_number(number, 1, dialect_, where));
    if (index <= dialect_.local_count) {
        locals().locals[static_cast<size_t>(index)] = value;
        return {};
    }
    FEELER_TRY(const bool taken, set_system_parameter(state_, environment_, index, value, where));
    if (taken) return {};
    state_.parameters.write().set_numbered(index, value);
    return {};
}

Value ProgramParameters::stored_value(double number) const {
    const auto index = parameter_number(number, 1, dialect_, {});
    if (!index) return {};
    const bool is_local = *index <= dialect_.local_count;
    return is_local ? locals().locals[static_cast<size_t>(*index)]
                    : state_.parameters->numbered(*index);
}

void ProgramParameters::restore_local(double number, Value value) {
    const auto index = parameter_number(number, 1, dialect_, {});
    if (index && *index <= dialect_.local_count)
        locals().locals[static_cast<size_t>(*index)] = value;
}

void ProgramParameters::restore_local(std::string_view name, Value value) {
    if (is_global(name)) return;
    NamedValues& own = state_.frames.back().named;
    if (value)
        own.insert_or_assign(std::string(name), *value);
    else if (const auto found = own.find(name); found != own.end())
        own.erase(found);
}

core::Result<void> ProgramParameters::set_named(std::string_view name, Value value,
                                                core::SourceSpan where) {
    if (system_parameter(state_, environment_, name))
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("#<{}> is read-only and cannot be set", name), where);
    const NamedValues& all = named_values(name);
    if (dialect_.names_are_declared) {
        if (all.find(name) == all.end()) return undeclared(name, where);
        const auto type = state_.frames.back().types.find(name);
        if (type != state_.frames.back().types.end())
            value = converted_to(type->second, value.value_or(0.0));
    }
    if (all.size() >= most_named_parameters && all.find(name) == all.end())
        return core::fail(ErrorCode::invalid_value, "too many named parameters", where);
    if (is_global(name))
        state_.parameters.write().set_named(name, value.value_or(0.0));
    else
        state_.frames.back().named.insert_or_assign(std::string(name), value.value_or(0.0));
    return {};
}

void ProgramParameters::forget_reads() const {
    unpredictable_.clear();
    reads_vary_ = false;
}

void ProgramParameters::note_read(int number, bool is_local) const {
    const Knowledge knowledge = is_local ? knowledge_of_locals()
                                : reads_unknown_position(state_.modal, environment_, number)
                                    ? Knowledge::unknown
                                    : knowledge_of(environment_, number);
    const bool is_set = is_local ? locals().locals[static_cast<size_t>(number)].has_value()
                                 : state_.parameters->numbered(number).has_value();
    const bool is_unknown = (knowledge == Knowledge::unknown_until_set && !is_set)
                            || (knowledge == Knowledge::unknown_once_set && is_set)
                            || knowledge == Knowledge::unknown;
    const bool is_marked = is_local
                               ? locals().unpredictable_locals >> static_cast<unsigned>(number) & 1U
                               : state_.parameters->is_unpredictable(number);
    if (!is_unknown && !is_marked) return;
    std::string name = shown_name(number);
    const UnknownValues& values = is_local ? locals().unknown : *state_.readings->unknown;
    const auto found = values.find(name);
    if (knowledge == Knowledge::unknown) {
        reads_vary_ = true;
        note_unpredictable(std::move(name), no_identity);
    } else if (found != values.end()) {
        note_unknown(found->second);
        if (!has_identity(number)) identity_ = no_identity;
    } else {
        const bool is_left = knowledge == Knowledge::unknown_until_set && !is_set;
        note_unpredictable(name, is_left && has_identity(number) ? name : no_identity);
    }
}

/// Whether a variable keeps its value until the program sets it. System variables may change
/// without that.
bool ProgramParameters::has_identity(int number) const {
    constexpr int first_preassigned = 100, last_preassigned = 199; // Q of Klartext
    if (dialect_.language == Language::klartext)
        return number < first_preassigned || number > last_preassigned;
    return !sets_the_machine(environment_, number)
           && !(is_fanuc(environment_) && is_of_clock(number));
}

/// Those of a macro are its arguments or vacant; those of the main program may be left over.
Knowledge ProgramParameters::knowledge_of_locals() const {
    constexpr ControlQuestion question = ControlQuestion::locals_are_kept;
    // LinuxCNC keeps them from program to program.
    const bool is_rs274 = dialect_.system_parameters == SystemParameters::rs274;
    const bool may_be_kept = is_rs274
                             || (find_parameter(question, environment_.dialect)
                                 && environment_.control.answer(question) != false);
    return may_be_kept && &locals() == &state_.frames.front() ? Knowledge::unknown_until_set
                                                              : Knowledge::known;
}

/// The name of a numbered variable as the program writes it.
std::string ProgramParameters::shown_name(int number) const {
    return fmt::format("{}{}", dialect_.parameter_letter, number == highest_parameter ? 0 : number);
}

void ProgramParameters::note_unpredictable(std::string name, std::string identity) const {
    identity_ = std::move(identity);
    if (std::find(unpredictable_.begin(), unpredictable_.end(), name) == unpredictable_.end())
        unpredictable_.push_back(std::move(name));
}

/// A variable that was computed stands for what it was computed from.
void ProgramParameters::note_unknown(const UnknownValue& value) const {
    for (const std::string& origin : value.origins) note_unpredictable(origin, {});
    identity_ = value.identity;
}

std::optional<UnknownValue> ProgramParameters::unknown_value(const ExpressionPool& pool,
                                                             Expression expression,
                                                             uint32_t line) const {
    if (unpredictable_.empty()) return std::nullopt;
    UnknownValue value{unpredictable_, no_identity};
    const ProgramParameters again(state_, environment_);
    Trace trace;
    const auto evaluated =
        evaluate(pool, expression, line, again, dialect_.arithmetic, nullptr, &trace);
    if (evaluated && !trace.identity.empty())
        value.identity = trace.is_negated ? "!" + trace.identity : trace.identity;
    return value;
}

/// An identity that no variable has. Identities of values that are gone are used again, so that a
/// loop that waits for an input comes back to the same state.
std::string ProgramParameters::fresh_identity(const UnknownValues& others) const {
    const auto is_used = [&](const std::string& identity) {
        const auto is_in = [&](const UnknownValues& values) {
            return std::any_of(values.begin(), values.end(), [&](const auto& value) {
                return value.second.identity.find(identity) != std::string::npos;
            });
        };
        const auto is_in_frame = [&](const Frame& frame) {
            return is_in(frame.unknown) || (frame.again && is_in(frame.again->unknown));
        };
        const auto is_in_macro = [&](const ModalMacro& macro) { return is_in(macro.unknown); };
        return is_in(others) || is_in(*state_.readings->unknown)
               || std::any_of(state_.frames.begin(), state_.frames.end(), is_in_frame)
               || std::any_of(state_.modal_macros.begin(), state_.modal_macros.end(), is_in_macro);
    };
    for (int i = 0;; ++i) {
        const std::string identity = fmt::format("?{};", i);
        if (is_used(identity)) continue;
        state_.readings.write().facts.forget(identity);
        return identity;
    }
}

/// Records what a variable that was just set stands for.
void ProgramParameters::keep(UnknownValues& values, std::string name,
                             std::optional<UnknownValue> value) {
    values.erase(name);
    if (value && value->identity == no_identity) value->identity = fresh_identity(values);
    if (value) values.insert_or_assign(std::move(name), *std::move(value));
}

void ProgramParameters::keep_shared(std::string name, std::optional<UnknownValue> value) {
    const UnknownValues& known = *state_.readings->unknown;
    if (!value && known.find(name) == known.end()) return;
    keep(state_.readings.write().unknown.write(), std::move(name), std::move(value));
}

void ProgramParameters::renew(const std::string& name) {
    keep_shared(name, UnknownValue{{name}, no_identity});
}

void ProgramParameters::renew(int number) {
    if (environment_.control.reports_premises) renew(shown_name(number));
}

void ProgramParameters::keep_argument(UnknownValues& arguments, size_t number,
                                      UnknownValue value) const {
    keep_argument(arguments, shown_name(static_cast<int>(number)), std::move(value));
}

void ProgramParameters::keep_argument(UnknownValues& arguments, std::string name,
                                      UnknownValue value) const {
    if (value.identity == no_identity) value.identity = fresh_identity(arguments);
    arguments.insert_or_assign(std::move(name), std::move(value));
}

void ProgramParameters::note_read(std::string_view name) const {
    const auto& marked = is_global(name) ? state_.parameters->unpredictable_names()
                                         : state_.frames.back().unpredictable_names;
    if (marked.find(name) == marked.end()) return;
    const UnknownValues& values =
        is_global(name) ? *state_.readings->unknown : state_.frames.back().unknown;
    const std::string shown = shown_name(name);
    const NamedValues& all = named_values(name);
    if (const auto found = values.find(shown); found != values.end())
        note_unknown(found->second);
    else
        note_unpredictable(shown,
                           is_global(name) && all.find(name) == all.end() ? shown : no_identity);
}

std::string ProgramParameters::shown_name(std::string_view name) const {
    return dialect_.names_are_declared ? std::string(name) : fmt::format("#<{}>", name);
}

void ProgramParameters::mark_numbered(double number, std::optional<UnknownValue> value) {
    const auto index = parameter_number(number, 1, dialect_, {});
    if (!index) return;
    const bool unpredictable = value.has_value();
    const bool is_local = *index <= dialect_.local_count;
    // Set to nothing, a variable is known to be vacant.
    if (!value && dialect_.unset_is_vacant && !stored_value(number)) value = UnknownValue{};
    const UnknownValues& values = is_local ? locals().unknown : *state_.readings->unknown;
    const bool changes = value || !values.empty();
    if (changes && is_local)
        keep(locals().unknown, shown_name(*index), std::move(value));
    else if (changes)
        keep_shared(shown_name(*index), std::move(value));
    if (is_local) {
        const uint64_t bit = uint64_t{1} << static_cast<unsigned>(*index);
        uint64_t& marks = locals().unpredictable_locals;
        marks = unpredictable ? marks | bit : marks & ~bit;
    } else if (state_.parameters->is_unpredictable(*index) != unpredictable) {
        state_.parameters.write().mark(*index, unpredictable);
    }
}

void ProgramParameters::mark_unknown(double number) {
    if (const auto index = parameter_number(number, 1, dialect_, {}))
        mark_numbered(*index, UnknownValue{{shown_name(*index)}, no_identity});
}

void ProgramParameters::mark_named(std::string_view name, std::optional<UnknownValue> value) {
    const bool unpredictable = value.has_value();
    if (is_global(name))
        keep_shared(shown_name(name), std::move(value));
    else
        keep(state_.frames.back().unknown, shown_name(name), std::move(value));
    if (is_global(name)) {
        const auto& marked = state_.parameters->unpredictable_names();
        if ((marked.find(name) != marked.end()) != unpredictable)
            state_.parameters.write().mark(name, unpredictable);
    } else if (unpredictable) {
        state_.frames.back().unpredictable_names.emplace(name);
    } else if (auto& marked = state_.frames.back().unpredictable_names; !marked.empty()) {
        if (const auto found = marked.find(name); found != marked.end()) marked.erase(found);
    }
}

void load_parameters(InterpreterState& state, const Environment& environment) {
    for (const auto& [number, value] : environment.parameters) {
        const auto taken = set_system_parameter(state, environment, number, value, {});
        const bool own = number > 0 && number <= highest_parameter;
        if (own && !(taken && *taken)) state.parameters.write().set_numbered(number, value);
    }
    for (const auto& [number, value] : environment.control.values)
        if (number >= 1 && number <= dialect(environment.dialect).local_count)
            state.frames.front().locals[static_cast<size_t>(number)] = value;
        else if (knowledge_of(environment, number) == Knowledge::unknown_until_set)
            state.parameters.write().set_numbered(
                stored_number(number, dialect(environment.dialect)), value);
    if (dialect(environment.dialect).names_are_declared) return;
    for (const auto& [name, value] : environment.control.named_values)
        if (value) state.parameters.write().set_named(name, value);
}

std::optional<Value> system_parameter(const InterpreterState& state, const Environment& environment,
                                      int number) {
    if (is_siemens(environment)) return std::nullopt;
    if (is_klartext(environment)) return q_parameter(state, number);
    if (is_fanuc(environment)) return fanuc_parameter(state, environment, number);
    return linuxcnc_parameter(state, environment, number);
}

std::optional<Value> system_parameter(const InterpreterState& state, const Environment& environment,
                                      std::string_view name) {
    if (const auto variable = functions_of(dialect(environment.dialect).language).variable)
        return variable(state, name);
    if (is_siemens(environment)) return std::nullopt;
    if (is_fanuc(environment)) return std::nullopt;
    return linuxcnc_parameter(state, environment, name);
}

core::Result<bool> set_system_parameter(InterpreterState& state, const Environment& environment,
                                        int number, Value value, core::SourceSpan where) {
    if (is_siemens(environment) || is_klartext(environment)) return false;
    if (is_fanuc(environment)) return set_fanuc_parameter(state, environment, number, value, where);
    return set_linuxcnc_parameter(state, environment, number, value, where);
}

bool sets_the_machine(const Environment& environment, int number) {
    if (is_siemens(environment) || is_klartext(environment)) return false;
    if (is_fanuc(environment)) return sets_fanuc_offset(environment, number);
    return sets_linuxcnc_position(number);
}

double converted_to(VariableType type, double value) {
    if (type == VariableType::whole) return core::round(value);
    if (type == VariableType::truth) return value != 0.0 ? 1.0 : 0.0;
    return value;
}

} // namespace gcode
