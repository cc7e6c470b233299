#include "app/check/other_readings.h"

#include <algorithm>
#include <iterator>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/check/block_runner.h"
#include "app/check/check_run.h"
#include "app/check/dog_legs.h"
#include "app/check/prepared_check.h"
#include "core/base/rule_table.h"
#include "core/base/text.h"
#include "core/sim/run/simulator.h"
#include "gcode/exec/readings.h"
#include "gcode/language/error_rules.h"
#include "gcode/text/source.h"

namespace app {
namespace {

constexpr size_t most_shown_errors = 20;

FindingKey key_of(const core::Finding& finding, const std::string& file, uint32_t line) {
    return {finding.rule, file, line, finding.pair[0], finding.pair[1]};
}

/// The block of a finding; empty if it is about the program as a whole.
std::optional<CheckedBlock> block_of(const core::Finding& finding, const CheckRecord& record) {
    if (!finding.block || core::value_of(*finding.block) >= record.blocks.size())
        return std::nullopt;
    return record.blocks[core::value_of(*finding.block)];
}

std::set<FindingKey> errors_of(const CheckRecord& record) {
    std::set<FindingKey> keys;
    for (const core::Finding& finding : record.findings) {
        if (finding.severity != core::Severity::error) continue;
        const auto block = block_of(finding, record);
        keys.insert(block ? key_of(finding, block->file, block->line) : key_of(finding, {}, 0));
    }
    return keys;
}

/// Whether a finding follows from the whole run after its end, which other readings do not repeat.
bool follows_from_whole_run(const core::Finding& finding) {
    constexpr std::string_view rules[] = {core::rule_id("nothing-cut"),
                                          core::rule_id("nothing-moves"),
                                          core::rule_id("gouge"),
                                          core::rule_id("rest-material"),
                                          core::rule_id("offset-implausible"),
                                          core::rule_id("implausible-value")};
    return std::find(std::begin(rules), std::end(rules), finding.rule) != std::end(rules);
}

/// The first error of the assumed reading, from the block of the premise on, that another reading
/// with these errors lacks.
std::optional<ReadingError> avoided_by(const std::set<FindingKey>& errors,
                                       const ReadingResult& result, const CheckRecord& record) {
    for (const core::Finding& finding : record.findings) {
        if (finding.severity != core::Severity::error || follows_from_whole_run(finding)) continue;
        const auto block = block_of(finding, record);
        if (!block || *finding.block < result.block) continue;
        if (!errors.contains(key_of(finding, block->file, block->line)))
            return ReadingError{block->line, block->file, finding};
    }
    return std::nullopt;
}

/// Adds an error of a reading, unless the assumed reading has the same.
void add_error(ReadingResult& result, const std::set<FindingKey>& known,
               const core::Finding& finding, const std::string& file, uint32_t line) {
    if (finding.severity != core::Severity::error) return;
    if (known.contains(key_of(finding, file, line))) return;
    ++result.error_count;
    if (result.errors.size() < most_shown_errors) result.errors.push_back({line, file, finding});
}

/// Whether this reading has an error that the assumed one has not, or a worse verdict; or, where
/// only the machine decides which way the program goes, one error less.
bool decides(const ReadingResult& result, core::Verdict assumed) {
    return result.error_count > 0 || result.verdict > assumed
           || (result.is_condition && result.avoided);
}

std::string place_of(const std::string& file, uint32_t line) {
    return file.empty() ? fmt::format("line {}", line) : fmt::format("line {} of {}", line, file);
}

std::string consequence_of(const ReadingResult& result) {
    if (result.errors.empty() && result.avoided)
        return fmt::format("the error in {} ({}) does not occur.",
                           place_of(result.avoided->file, result.avoided->line),
                           result.avoided->finding.rule);
    if (result.errors.empty() && result.stopped)
        return fmt::format("the check stops in {}, and what follows is not checked: {}.",
                           place_of(result.stopped->file, result.stopped->where.line),
                           result.stopped->message);
    if (result.errors.empty())
        return fmt::format("the verdict is {}.", core::name_of(result.verdict));
    const ReadingError& first = result.errors.front();
    std::string text =
        fmt::format("{} has an error ({}): {}",
                    first.line ? place_of(first.file, first.line) : "the program as a whole",
                    first.finding.rule, first.finding.message);
    if (result.error_count > 1)
        text += fmt::format(" {} more follow{}.", result.error_count - 1,
                            result.ends_early ? "; what comes after them was not checked" : "");
    return text;
}

/// The severity of the finding about a reading. A collision is an error whatever the set-up says
/// about the rule. What the set-up lowers in the assumed reading is lowered here, too.
core::Severity severity_of(const core::Setup& setup, const ReadingResult& result) {
    if (result.verdict == core::Verdict::collision) return core::Severity::error;
    const core::Severity own = core::severity_of(setup, core::rule_id("open-premise"));
    if (result.error_count > 0 || result.stopped || result.avoided) return own;
    if (result.verdict == core::Verdict::violation)
        return std::min(own, std::max(result.lowered, core::Severity::note));
    return std::min(
        own, std::max(core::severity_of(setup, core::rule_id("undecided")), core::Severity::note));
}

core::Finding open_premise(core::Severity severity, std::string message, std::string cure) {
    core::Finding finding;
    finding.rule = core::rule_id("open-premise");
    finding.severity = severity;
    finding.message = std::move(message);
    finding.cure = std::move(cure);
    return finding;
}

/// The first of several ways in which a premise can be read.
std::string ways_text(std::vector<std::string> ways) {
    constexpr size_t most_shown = 3;
    const size_t more = ways.size() > most_shown ? ways.size() - most_shown : 0;
    ways.resize(ways.size() - more);
    return fmt::format("{}{}", fmt::join(ways, ", or if "),
                       more ? fmt::format(", or in {} more ways", more) : "");
}

std::string way_of(const ReadingResult& result) {
    return fmt::to_string(fmt::join(result.when, " and "));
}

/// Readings that are told in one finding, because only what they read differs.
struct ToldReadings {
    std::string place;
    std::string begin, end, cure; // of the text, before and after the ways to read the premise
    core::BlockIndex block{};
    std::vector<std::string> ways;
    core::Severity severity = core::Severity::off;
    bool tells_rapids = false; // the premise is whether rapids are straight

    bool begins_and_ends_as(const ToldReadings& other) const {
        return begin == other.begin && end == other.end && cure == other.cure
               && block == other.block;
    }
};

/// A member of the premises that differ from the assumed reading, each text once.
std::vector<std::string> each_of(const ReadingResult& result, std::string PremiseText::*member) {
    std::vector<std::string> texts;
    const auto add = [&](const PremiseText& premise) {
        const std::string& text = premise.*member;
        if (std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
    };
    for (const PremiseText& premise : result.earlier) add(premise);
    add(result.premise);
    return texts;
}

ToldReadings told(const core::Setup& setup, const ReadingResult& result) {
    const std::string effect =
        result.effect.empty() ? std::string() : fmt::format(" ({})", result.effect);
    return {.place = place_of(result.file, result.line),
            .begin = fmt::format("{}. Assumed: {}. If ",
                                 fmt::join(each_of(result, &PremiseText::reason), ". "),
                                 fmt::join(each_of(result, &PremiseText::assumed), ", and ")),
            .end = fmt::format("{}, {}", effect, consequence_of(result)),
            .cure = result.cure(),
            .block = result.block,
            .ways = {way_of(result)},
            .severity = severity_of(setup, result)};
}

/// The finding for readings. Where the check stopped in their block, it is not recorded.
core::Finding finding_of(const CheckRecord& record, const ToldReadings& readings) {
    const bool is_recorded = core::value_of(readings.block) < record.blocks.size();
    const std::string text = readings.begin + ways_text(readings.ways) + readings.end;
    core::Finding finding = open_premise(
        readings.severity, is_recorded ? text : fmt::format("In {}: {}", readings.place, text),
        readings.cure);
    if (is_recorded) finding.block = readings.block;
    return finding;
}

/// A reading that was reported.
struct ReportedReading {
    std::set<std::string> when;
    std::set<FindingKey> errors;
    core::Verdict verdict;
};

/// Whether one of the reported readings has all these errors, although less of it differs from the
/// assumed reading.
bool is_explained(const std::vector<ReportedReading>& reported, const ReportedReading& reading) {
    return !reading.errors.empty()
           && std::any_of(reported.begin(), reported.end(), [&](const ReportedReading& other) {
                  return other.verdict >= reading.verdict
                         && std::includes(reading.when.begin(), reading.when.end(),
                                          other.when.begin(), other.when.end())
                         && std::includes(other.errors.begin(), other.errors.end(),
                                          reading.errors.begin(), reading.errors.end());
              });
}

/// What the readings that were followed depend on: each reason once, the first ones only.
std::string reasons_of(const std::vector<ReadingResult>& readings) {
    constexpr size_t most_shown = 8;
    std::vector<std::string> reasons;
    for (const ReadingResult& reading : readings)
        if (std::find(reasons.begin(), reasons.end(), reading.premise.reason) == reasons.end())
            reasons.push_back(reading.premise.reason);
    const size_t shown = std::min(reasons.size(), most_shown);
    const std::string more = shown < reasons.size()
                                 ? fmt::format("; and {} more", reasons.size() - shown)
                                 : std::string();
    reasons.resize(shown);
    return fmt::format("{}{}", fmt::join(reasons, "; "), more);
}

/// Conditions on the same unknown value of which no outcome makes a difference.
std::string note_of(const std::string& reason, const std::set<std::string>& places) {
    constexpr size_t most_shown = 4;
    std::vector<std::string> shown(places.begin(), places.end());
    const size_t count = shown.size();
    if (count > most_shown) shown.resize(most_shown);
    return fmt::format("{}; there are no further errors with the other outcome, in {}{}",
                       core::lower_case(reason.substr(0, 1)) + reason.substr(1),
                       fmt::join(shown, ", "),
                       count > most_shown ? fmt::format(" and {} more", count - most_shown) : "");
}

core::Finding too_many(const core::Setup& setup, const std::vector<ReadingResult>& followed) {
    return open_premise(core::severity_of(setup, core::rule_id("open-premise")),
                        fmt::format("The program can take more than {} ways, depending on values "
                                    "that only the machine knows. The others were not checked. "
                                    "{}.",
                                    most_readings, reasons_of(followed)),
                        "State these values under [program.values] in the set-up.");
}

/// The severity of a finding for which the set-up lowers that of its rule.
core::Severity lowered_severity(const core::Finding& finding) {
    const bool is_lowered = core::default_severity(finding.rule) == core::Severity::error;
    return is_lowered ? finding.severity : core::Severity::off;
}

} // namespace

std::string ReadingResult::cure() const {
    return fmt::to_string(fmt::join(each_of(*this, &PremiseText::cure), " "));
}

bool OtherReadings::is_known(const Crossing& crossing, const RunState& before) {
    const gcode::Facts& facts = before.control.readings->facts;
    std::vector<gcode::Facts>& visits = visited_[crossing];
    const bool goes_past = running_ && running_->goes_past == crossing;
    if (visits.empty() || goes_past) {
        visits.push_back(facts);
        return false;
    }
    if (std::find(visits.begin(), visits.end(), facts) == visits.end() && running_) {
        Fork fork{before, running_->result, running_->parent, crossing};
        fork.result.continues = true;
        stopped_.push_back({std::move(fork), visits});
        visits.push_back(facts);
    }
    return true;
}

void OtherReadings::add_fork(Fork fork) {
    if (!has_too_many_ && forks_.size() >= most_readings) {
        has_too_many_ = true;
        if (!running_) too_many_from_ = core::value_of(fork.result.block);
    }
    if (!has_too_many_) forks_.push_back(std::move(fork));
}

void OtherReadings::assume(const gcode::OpenPremise& premise, size_t blocks) {
    std::string clause = fmt::format("it is assumed that {}, which the set-up does not state",
                                     premise.readings.front().when);
    const auto is_same = [&](const Assumed& other) { return other.clause == clause; };
    if (std::none_of(assumed_.begin(), assumed_.end(), is_same))
        assumed_.push_back({blocks, std::move(clause)});
}

bool OtherReadings::note(const RunState& before, const gcode::InterpreterState& after,
                         size_t blocks) {
    const auto& met = after.readings->met;
    const size_t first = before.control.readings->met.size();
    for (size_t i = first; i < met.size(); ++i) {
        const gcode::OpenPremise& premise = met[i];
        if (premise.readings.size() == 1) assume(premise, blocks);
        if (premise.is_chosen || has_too_many_) continue;
        gcode::PremiseId where = premise.id;
        where.occurrence = 0;
        if (!premise.id.question && is_known({where, digest_of(before)}, before)) return true;
        for (size_t other = 0; other < premise.readings.size(); ++other) {
            if (other == premise.taken) continue;
            Fork fork{before, {}, outcome_};
            gcode::Readings& readings = fork.state.control.readings.write();
            for (size_t j = first; j < i; ++j) readings.chosen[met[j].id] = met[j].taken;
            readings.chosen[premise.id] = other;
            if (running_) {
                fork.result.when = running_->result.when;
                fork.result.earlier = running_->result.earlier;
                fork.result.earlier.push_back(running_->result.premise);
            }
            fork.result.premise = {premise.reason, premise.readings[premise.taken].when,
                                   premise.cure};
            fork.result.when.push_back(premise.readings[other].when);
            fork.result.effect = premise.readings[other].effect;
            fork.result.block = core::BlockIndex{static_cast<uint32_t>(blocks)};
            fork.result.line = premise.line;
            fork.result.is_condition = !premise.id.question;
            const uint32_t source =
                premise.id.question ? before.control.next.source : premise.id.line.source;
            if (source != 0) fork.result.file = check_.library->program(source).file;
            add_fork(std::move(fork));
        }
    }
    return false;
}

bool OtherReadings::has_open_rapids() const {
    return open_rapid_parameter(check_.file.environment) != nullptr;
}

void OtherReadings::note_dog_legs(const BlockStep& step) {
    if (!step.as_dog_legs) return;
    const CheckedBlock& block = step.checked;
    bent_.push_back(
        {block.block, block.line, block.file, step.as_dog_legs->verdict, step.as_dog_legs->errors});
}

ReadingResult OtherReadings::bent_reading(const std::vector<BentBlock>& blocks,
                                          const ReadingResult* in) const {
    const gcode::ControlParameter& parameter = *open_rapid_parameter(check_.file.environment);
    gcode::OpenPremise premise = gcode::premise_of(parameter, check_.file.environment);
    ReadingResult result;
    result.premise = {std::move(premise.reason), premise.readings[0].when, std::move(premise.cure)};
    if (in) {
        result.when = in->when;
        result.earlier = in->earlier;
        result.earlier.push_back(in->premise);
    }
    result.when.push_back(premise.readings[1].when);
    result.effect = premise.readings[1].effect;
    result.block = blocks.front().block;
    result.line = blocks.front().line;
    result.file = blocks.front().file;
    for (const BentBlock& block : blocks) {
        result.verdict = std::max(result.verdict, block.verdict);
        result.error_count += block.errors.size();
        for (const core::Finding& error : block.errors)
            if (result.errors.size() < most_shown_errors)
                result.errors.push_back({block.line, block.file, error});
    }
    return result;
}

void OtherReadings::resume_runs() {
    const auto differs = [&](const StoppedRun& run) {
        const gcode::Facts& own = run.fork.state.control.readings->facts;
        return std::any_of(repeated_.begin(), repeated_.end(), [&](const std::string& identity) {
            return std::any_of(
                run.others.begin(), run.others.end(),
                [&](const gcode::Facts& other) { return !own.agree_on(identity, other); });
        });
    };
    const auto resumed = std::stable_partition(
        stopped_.begin(), stopped_.end(), [&](const StoppedRun& run) { return !differs(run); });
    for (auto run = resumed; run != stopped_.end(); ++run) add_fork(std::move(run->fork));
    stopped_.erase(resumed, stopped_.end());
}

void OtherReadings::forget_from(size_t blocks) {
    std::erase_if(forks_,
                  [&](const Fork& fork) { return core::value_of(fork.result.block) >= blocks; });
    std::erase_if(assumed_, [&](const Assumed& premise) { return premise.block >= blocks; });
    std::erase_if(bent_,
                  [&](const BentBlock& bent) { return core::value_of(bent.block) >= blocks; });
    visited_.clear();
    stopped_.clear();
    if (too_many_from_ && *too_many_from_ >= blocks) too_many_from_.reset();
    has_too_many_ = too_many_from_.has_value();
}

ReadingResult OtherReadings::run(Fork fork, const CheckRecord& record,
                                 const std::function<bool()>& goes_on,
                                 std::set<FindingKey>& new_errors) {
    ReadingResult result = fork.result;
    RunState& state = fork.state;
    std::set<FindingKey> known = errors_of(record);
    outcome_ = std::make_shared<Outcome>();
    if (fork.parent) {
        *outcome_ = *fork.parent;
        known.insert(outcome_->errors.begin(), outcome_->errors.end());
    }
    running_ = &fork;
    BlockRunner runner(check_);
    runner.follows_dog_legs = has_open_rapids();
    runner.use_threads(threads);
    std::vector<BentBlock> bent;
    std::set<FindingKey> errors;
    bool joins = false;
    const bool may_end_early =
        core::severity_of(check_.run.setup, core::rule_id("open-premise")) == core::Severity::error;
    const size_t forks_before = forks_.size();
    const size_t stopped_before = stopped_.size();
    const auto visited_before = visited_;
    size_t blocks = core::value_of(result.block);
    runner.after_reading = [&](const RunState& before, const gcode::InterpreterState& after) {
        joins = note(before, after, core::value_of(result.block));
    };
    while (!joins) {
        const auto step = runner.step(state);
        if (joins) break;
        if (!step) {
            result.stopped = step.error();
            if (result.stopped->file == check_.library->program(0).file)
                result.stopped->file.clear();
        }
        if (!step || !*step) break;
        const BlockStep& done = **step;
        result.verdict = std::max(result.verdict, done.checked.result.verdict);
        if (done.as_dog_legs)
            bent.push_back({result.block, done.checked.line, done.checked.file,
                            done.as_dog_legs->verdict, done.as_dog_legs->errors});
        for (const core::Finding& finding : done.findings) {
            if (finding.severity == core::Severity::error)
                errors.insert(key_of(finding, done.checked.file, done.checked.line));
            else
                result.lowered = std::max(result.lowered, lowered_severity(finding));
            add_error(result, known, finding, done.checked.file, done.checked.line);
        }
        // More errors would tell nobody more, unless a set-up reports only collisions.
        const size_t enough =
            result.verdict == core::Verdict::collision ? most_shown_errors : 10 * most_shown_errors;
        result.ends_early = may_end_early && result.error_count >= enough;
        if (result.ends_early) break;
        if (++blocks % 256 == 0 && !goes_on()) {
            result.stopped = core::Error{core::ErrorCode::io, {}, "stopped by the user", {}};
            result.verdict = std::max(result.verdict, core::Verdict::undecided);
            break;
        }
    }
    if (!joins && !result.ends_early)
        for (const core::Finding& finding : core::end_of_run(check_.run.setup, state.machine)) {
            if (finding.severity == core::Severity::error) errors.insert(key_of(finding, {}, 0));
            add_error(result, known, finding, {}, 0);
        }
    if (!joins && !result.stopped && !result.continues && !result.ends_early)
        result.avoided = avoided_by(errors, result, record);
    if (result.ends_early) { // what other readings rely on ends here, too
        result.verdict = std::max(result.verdict, core::Verdict::undecided);
        forks_.erase(forks_.begin() + static_cast<std::ptrdiff_t>(forks_before), forks_.end());
        stopped_.erase(stopped_.begin() + static_cast<std::ptrdiff_t>(stopped_before),
                       stopped_.end());
        visited_ = visited_before;
    }
    // One finding about rapids is enough, but the verdict is that of the worst combination.
    for (const BentBlock& block : bent) worst_bent_ = std::max(worst_bent_, block.verdict);
    if (!bent.empty() && bent_.empty()) bent_readings_.push_back(bent_reading(bent, &result));
    for (const std::string& condition : state.control.readings->repeated)
        repeated_.insert(condition);
    running_ = nullptr;
    std::set_difference(errors.begin(), errors.end(), known.begin(), known.end(),
                        std::inserter(new_errors, new_errors.end()));
    outcome_->errors.insert(errors.begin(), errors.end());
    // Where the control stops with an alarm, nothing moves any more. Other stops are those of the
    // check alone: the control may know the word, or have the subprogram.
    const bool is_alarm = result.stopped
                          && (result.stopped->code == gcode::program_alarm
                              || !gcode::rule_of(*result.stopped).empty());
    if (result.stopped && !is_alarm)
        result.verdict = std::max(result.verdict, core::Verdict::undecided);
    outcome_->verdict = std::max(outcome_->verdict, result.verdict);
    outcome_ = nullptr;
    return result;
}

void OtherReadings::follow(CheckRecord& record, const gcode::InterpreterState& last,
                           const std::function<bool()>& goes_on) {
    const core::Setup& setup = check_.run.setup;
    // What a program does after the block in which the check stopped is not known.
    const core::Verdict assumed =
        record.stopped ? std::max(record.verdict, core::Verdict::undecided) : record.verdict;
    std::vector<ToldReadings> found;
    std::vector<ReportedReading> reported;
    std::set<std::string> harmless;
    std::map<std::string, std::set<std::string>>
        conditions;                                       // harmless ones, by what they depend on
    std::map<std::string, std::vector<std::string>> ways; // harmless readings, by what is assumed
    repeated_ = last.readings->repeated;
    std::vector<Fork> kept_forks;
    if (may_go_back) kept_forks = forks_;
    const std::vector<Assumed> kept_assumed = assumed_;
    const core::Severity own = core::severity_of(setup, core::rule_id("open-premise"));
    const auto take_verdict = [&](core::Verdict verdict) {
        if (own != core::Severity::off || verdict == core::Verdict::collision)
            record.verdict = std::max(record.verdict, verdict);
    };
    const auto report = [&](const ReadingResult& result) -> ToldReadings& {
        if (setup.rules.find(core::rule_id("open-premise")) == setup.rules.end())
            record.verdict = std::max(record.verdict, core::Verdict::undecided);
        ToldReadings readings = told(setup, result);
        const auto same = std::find_if(found.begin(), found.end(), [&](const ToldReadings& other) {
            return other.begins_and_ends_as(readings);
        });
        if (same == found.end()) return found.emplace_back(std::move(readings));
        same->severity = std::max(same->severity, readings.severity);
        if (std::find(same->ways.begin(), same->ways.end(), way_of(result)) == same->ways.end())
            same->ways.push_back(way_of(result));
        return *same;
    };
    const auto add_bent = [&](ReadingResult result) {
        take_verdict(result.verdict);
        report(result).tells_rapids = true;
        record.readings.push_back(std::move(result));
    };
    if (!bent_.empty()) add_bent(bent_reading(bent_, nullptr));
    for (size_t i = 0; i < forks_.size(); ++i) {
        const std::shared_ptr<const Outcome> parent = forks_[i].parent;
        ReportedReading reading;
        ReadingResult result = run(std::move(forks_[i]), record, goes_on, reading.errors);
        reading.when.insert(result.when.begin(), result.when.end());
        reading.verdict = result.verdict;
        take_verdict(result.verdict);
        if (decides(result, parent ? std::max(assumed, parent->verdict) : assumed)) {
            if (!is_explained(reported, reading)) report(result);
            reported.push_back(std::move(reading));
        } else if (result.is_condition && !result.avoided) {
            conditions[result.premise.reason].insert(place_of(result.file, result.line));
        } else {
            const std::string effect =
                result.avoided ? fmt::format("the error in {} ({}) does not occur",
                                             place_of(result.avoided->file, result.avoided->line),
                                             result.avoided->finding.rule)
                               : "there are no further errors";
            ways[fmt::format("{}: it is assumed that {}; {}", place_of(result.file, result.line),
                             result.premise.assumed, effect)]
                .push_back(way_of(result));
        }
        record.readings.push_back(std::move(result));
        if (i + 1 == forks_.size()) resume_runs();
    }
    for (ReadingResult& bent : bent_readings_) add_bent(std::move(bent));
    take_verdict(worst_bent_);
    for (ToldReadings& readings : found)
        if (readings.tells_rapids && worst_bent_ == core::Verdict::collision)
            readings.severity = core::Severity::error;
    worst_bent_ = core::Verdict::clear;
    bent_readings_.clear();
    for (Assumed& premise : assumed_) record.later_assumptions.push_back(std::move(premise.clause));
    assumed_ = kept_assumed;
    for (const auto& [reason, places] : conditions) harmless.insert(note_of(reason, places));
    for (const auto& [note, others] : ways) harmless.insert(note + " if " + ways_text(others));
    for (const std::string& note : harmless) record.later_assumptions.push_back(note);
    std::vector<core::Finding> findings;
    for (const ToldReadings& readings : found) findings.push_back(finding_of(record, readings));
    if (has_too_many_) {
        findings.push_back(too_many(setup, record.readings));
        record.verdict = std::max(record.verdict, core::Verdict::undecided);
        if (own == core::Severity::off)
            record.later_assumptions.push_back(
                fmt::format("the program can take more than {} ways; the others were not checked",
                            most_readings));
    }
    for (core::Finding& finding : findings)
        if (finding.severity != core::Severity::off) record.findings.push_back(std::move(finding));
    forks_ = std::move(kept_forks);
    stopped_.clear();
}

} // namespace app
