#include "gcode/iso/iso.h"
#include "gcode/klartext/klartext.h"
#include "gcode/language/dialect.h"
#include "gcode/language/language.h"
#include "gcode/siemens/siemens.h"

namespace gcode {

const LanguageFunctions& functions_of(Language language) {
    constexpr const LanguageFunctions* languages[] = {&iso_language, &klartext_language,
                                                      &siemens_language};
    static_assert(static_cast<size_t>(Language::siemens) == 2);
    return *languages[static_cast<size_t>(language)];
}

} // namespace gcode
