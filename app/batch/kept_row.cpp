#include "app/batch/kept_row.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/session/digest.h"

namespace app {

std::string answer_text(const InputFile& input) { return input.answer ? "=" + *input.answer : ""; }

std::string looks_of(std::vector<InputFile> inputs) {
    std::sort(inputs.begin(), inputs.end());
    std::string text;
    for (const InputFile& input : inputs) {
        text += fmt::format("{}", static_cast<int>(input.question));
        for (const std::string& part : {input.path, input.name, answer_text(input)})
            text += fmt::format(" {}:{}", part.size(), part);
    }
    return sha256_of(text);
}

std::string seal_of(const KeptRow& row) { return sha256_of(row.key + row.looks + row.value); }

bool is_sound(const KeptRow& row) {
    return row.seal == seal_of(row) && row.looks == looks_of(row.inputs);
}

} // namespace app
