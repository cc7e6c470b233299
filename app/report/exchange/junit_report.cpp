#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "app/base/findings.h"
#include "app/base/text.h"
#include "app/report/exchange/exchange_reports.h"
#include "core/base/rule_table.h"

namespace app {
namespace {

/// A character escaped for XML 1.0, which does not allow most control characters at all.
std::string xml_character(char c) {
    switch (c) {
    case '&':
        return "&amp;";
    case '<':
        return "&lt;";
    case '>':
        return "&gt;";
    case '"':
        return "&quot;";
    case '\r':
        return "&#13;";
    case '\n':
    case '\t':
        return {c};
    default:
        return static_cast<unsigned char>(c) < 0x20 ? "?" : std::string(1, c);
    }
}

/// A UTF-8 text, escaped for the inside of an element.
std::string xml_text(const std::string& text) {
    std::string safe;
    for (size_t i = 0; i < text.size(); ++i) {
        // XML does not allow U+FFFE and U+FFFF.
        const bool is_none =
            text.compare(i, 3, "\xEF\xBF\xBE") == 0 || text.compare(i, 3, "\xEF\xBF\xBF") == 0;
        safe += is_none ? "?" : xml_character(text[i]);
        if (is_none) i += 2;
    }
    return safe;
}

/// As xml_text, for an attribute value, where a line end would be read as a blank.
std::string xml_attribute(const std::string& text) {
    std::string safe;
    for (const char c : xml_text(text))
        safe += c == '\n' || c == '\t' ? fmt::format("&#{};", int(c)) : std::string(1, c);
    return safe;
}

std::string finding_text(const StoredFinding& finding) {
    const std::string location =
        finding_location(finding.line, finding.file, finding.text, std::string::npos);
    std::string text = finding_title(finding) + location + "\n    " + finding.message;
    if (!finding.cure.empty()) text += "\n    " + cure_text(finding);
    return text + "\n";
}

/// The findings that are errors, or those that are not.
std::string finding_texts(const ProgramResult& program, bool errors) {
    std::string text;
    for (const StoredFinding& finding : program.findings)
        if ((finding.severity == core::Severity::error) == errors) text += finding_text(finding);
    return text;
}

/// The headline and what was not checked.
std::string coverage_text(const ProgramResult& program) {
    const std::string uncovered = uncovered_text(program);
    if (uncovered.empty()) return {};
    return headline_of(program) + "\n    unchecked: " + uncovered + "\n";
}

/// Folder and file name of a program, as attributes of its test case.
std::string name_attributes(const std::string& program) {
    const std::filesystem::path path(program);
    const std::string folder = path.parent_path().generic_string();
    return fmt::format("name=\"{}\" classname=\"{}\"",
                       xml_attribute(path.filename().generic_string()),
                       xml_attribute(folder.empty() ? "." : folder));
}

/// The type of a failure: the verdict or, if that is clear, what kind of error there is.
const char* failure_type(const ProgramResult& program) {
    if (program.verdict != core::Verdict::clear) return core::name_of(program.verdict);
    const bool in_program =
        std::any_of(program.findings.begin(), program.findings.end(), is_error_of_program);
    return in_program ? "error" : core::rule_id("incomplete-setup");
}

std::string case_of(const ProgramResult& program) {
    std::string text = fmt::format("    <testcase {} time=\"{:.3f}\">\n",
                                   name_attributes(program.program), program.seconds);
    const std::string errors = finding_texts(program, true);
    const std::string others = coverage_text(program) + finding_texts(program, false);
    if (program.error) {
        const StoredError& error = *program.error;
        const std::string location = error.line == 0 ? "" : fmt::format("line {}: ", error.line);
        text += fmt::format(
            "      <error message=\"{}\" type=\"not-run-to-its-end\">{}</error>\n",
            xml_attribute(location + error.message),
            xml_text(fmt::format("{}:{}: {}\n{}", error.file, error.line, error.message, errors)));
    } else if (!errors.empty()) {
        text += fmt::format("      <failure message=\"{}: {}\" type=\"{}\">{}</failure>\n",
                            program.verdict == core::Verdict::clear
                                ? xml_attribute(headline_of(program))
                                : core::name_of(program.verdict),
                            counted(count_of(program, core::Severity::error), "error"),
                            failure_type(program), xml_text(errors));
    }
    if (!others.empty()) text += "      <system-out>" + xml_text(others) + "</system-out>\n";
    return text + "    </testcase>\n";
}

} // namespace

std::string junit_report(const BatchResult& batch) {
    size_t failures = 0, errors = 0;
    double seconds = 0.0;
    std::string cases;
    for (const ProgramResult& program : batch.programs) {
        errors += status_of(program) == 2;
        failures += status_of(program) == 1;
        seconds += program.seconds;
        cases += case_of(program);
    }
    for (const std::string& program : batch.unchecked)
        cases +=
            fmt::format("    <testcase {} time=\"0\">\n      <error message=\"was not checked: "
                        "the batch was stopped before it\"/>\n    </testcase>\n",
                        name_attributes(program));
    errors += batch.unchecked.size(); // so that an incomplete batch does not pass
    const std::string counts =
        fmt::format("tests=\"{}\" failures=\"{}\" errors=\"{}\" time=\"{:.3f}\"",
                    batch.programs.size() + batch.unchecked.size(), failures, errors, seconds);
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
           + fmt::format("<testsuites name=\"feeler\" {0}>\n  <testsuite name=\"feeler check{1}\" "
                         "{0} skipped=\"0\">\n{2}  </testsuite>\n</testsuites>\n",
                         counts, batch.shard.empty() ? "" : ", " + batch.shard, cases);
}

} // namespace app
