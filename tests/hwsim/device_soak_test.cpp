#include "tests/hwsim/functional_answers.h"

namespace hwsim {
namespace {

TEST(DeviceSoak, AnswersAsTheFunctionalModel) {
    expect_the_functional_answers(21, small_config(), 100'000, 2'000);
    expect_the_functional_answers(22, DeviceConfig{.memory_lines = 4096}, 3'000'000, 1'000);
}

TEST(DeviceSoak, AnswersAsTheFunctionalModelOnALattice) {
    for (const int32_t reach : {1, 2, 4, 9})
        expect_the_functional_answers(static_cast<uint32_t>(30 + reach), small_config(), reach,
                                      1'000);
}

} // namespace
} // namespace hwsim
