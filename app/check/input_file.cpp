#include "app/check/input_file.h"

#include "app/base/sha256.h"

namespace app {

InputRecorder::InputRecorder() : listening_([this](const core::FileAccess& look) { note(look); }) {}

void InputRecorder::note(const core::FileAccess& look) {
    InputFile input{look.question, look.path, look.name, std::nullopt};
    if (look.answer)
        input.answer = look.question == core::FileQuestion::content ? sha256_of(*look.answer)
                                                                    : std::string(*look.answer);
    inputs_.insert(std::move(input));
}

} // namespace app
