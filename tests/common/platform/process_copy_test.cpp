// GPL-2.0-or-later. Copies of the process: messages, and what is left of a copy that crashes.
#include "common/platform/process_copy.h"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3::test {
namespace {

constexpr CopyLimits kLimits{.moreBytes = 1u << 30, .cpuSeconds = 1};

class ProcessCopyTest : public testing::Test {
  protected:
    void SetUp() override {
        if (!ProcessCopy::IsAvailable())
            GTEST_SKIP() << "this system has no copies of processes";
    }
};

std::vector<std::byte> Numbers(std::size_t count) {
    std::vector<std::byte> bytes(count);
    for (std::size_t i = 0; i < count; ++i)
        bytes[i] = std::byte(i * 7 % 251);
    return bytes;
}

TEST_F(ProcessCopyTest, MessagesArriveWhole) {
    ProcessCopy copy(kLimits, [](Channel &channel) {
        while (auto message = channel.Receive()) {
            std::ranges::reverse(*message);
            channel.Send(*message);
        }
    });
    for (const std::size_t size : {0, 1, 100, 3000000}) {
        std::vector<std::byte> bytes = Numbers(size);
        EXPECT_TRUE(copy.ToCopy().Send(bytes));
        std::ranges::reverse(bytes);
        EXPECT_EQ(copy.ToCopy().Receive(), bytes);
    }
}

TEST_F(ProcessCopyTest, MemoryIsACopy) {
    int number = 1;
    ProcessCopy copy(kLimits, [&number](Channel &channel) {
        number = 2;
        channel.Send({});
    });
    EXPECT_TRUE(copy.ToCopy().Receive());
    EXPECT_FALSE(copy.ToCopy().Receive());
    EXPECT_EQ(copy.Wait(), "");
    EXPECT_EQ(number, 1);
}

TEST_F(ProcessCopyTest, ACrashEndsOnlyTheCopy) {
    ProcessCopy copy(kLimits, [](Channel &) { std::raise(SIGSEGV); });
    EXPECT_FALSE(copy.ToCopy().Receive());
    EXPECT_FALSE(copy.ToCopy().Send(Numbers(10)));
    EXPECT_THAT(copy.Wait(), testing::HasSubstr("egmentation"));
    EXPECT_EQ(copy.Wait(), "");
}

TEST_F(ProcessCopyTest, ALoopEnds) {
    ProcessCopy copy(kLimits, [](Channel &) {
        const std::atomic<bool> goesOn{true};
        while (goesOn) {
        }
    });
    EXPECT_FALSE(copy.ToCopy().Receive());
    EXPECT_EQ(copy.Wait(), "it takes too long");
}

TEST_F(ProcessCopyTest, ACopyThatIsNotNeededIsEnded) {
    const ProcessCopy copy(kLimits, [](Channel &channel) { channel.Receive(); });
}

} // namespace
} // namespace q3::test
