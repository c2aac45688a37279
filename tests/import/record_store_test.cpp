#include "preprocess/import/record_store.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "tests/common/temp_directory.hpp"

namespace iwalk {
namespace {

using Record = std::array<std::uint64_t, 3>;

Record recordAt(std::uint64_t index) {
    return {index, ~index, index * 77};
}

void fill(RecordStore& store, std::uint64_t count) {
    while (store.size() < count) {
        const Record record = recordAt(store.size());
        auto room = store.append();
        ASSERT_TRUE(room.ok()) << room.error().message;
        std::memcpy(*room, &record, sizeof record);
    }
}

void expectRecord(RecordStore& store, std::uint64_t index) {
    const auto found = store.load(index);
    ASSERT_TRUE(found.ok()) << found.error().message;
    Record record;
    std::memcpy(&record, *found, sizeof record);
    ASSERT_EQ(record, recordAt(index));
    ASSERT_EQ(store.find(index), *found);
}

TEST(RecordStoreTest, readsBackWhatWasAppended) {
    const TempDirectory directory;
    constexpr std::uint64_t kCount = 100000;  // 2.4 MB
    for (const std::uint64_t memory : {std::uint64_t{0}, std::uint64_t{1} << 20, std::uint64_t{1} << 30}) {
        RecordStore store(sizeof(Record), memory, directory.path(""));
        fill(store, kCount);
        for (std::uint64_t i = 0; i < kCount; ++i) expectRecord(store, i);
        std::mt19937_64 random(1);
        for (int i = 0; i < 20000; ++i) expectRecord(store, random() % kCount);
        EXPECT_TRUE(directory.list().empty());
    }
}

TEST(RecordStoreTest, appendsAfterReads) {
    const TempDirectory directory;
    RecordStore store(sizeof(Record), 0, directory.path(""));
    std::mt19937_64 random(2);
    for (std::uint64_t size = 1000; size <= 60000; size += 777) {
        fill(store, size);
        for (int i = 0; i < 200; ++i) expectRecord(store, random() % size);
    }
    for (std::uint64_t i = 0; i < store.size(); ++i) expectRecord(store, i);
}

TEST(RecordStoreTest, staysInMemoryBelowTheLimit) {
    RecordStore store(sizeof(Record), std::uint64_t{64} << 20, "/nowhere");
    fill(store, 100000);
    expectRecord(store, 0);
}

TEST(RecordStoreTest, aSpillFileThatCannotBeMadeIsAnError) {
    RecordStore store(sizeof(Record), 0, "/nowhere");
    Result<std::byte*> room = store.append();
    while (room.ok() && store.size() < 100000) room = store.append();
    ASSERT_FALSE(room.ok());
    EXPECT_EQ(room.error().message,
              "/nowhere: cannot make a spill file (No such file or directory): give a directory that can be "
              "written");
}

}  // namespace
}  // namespace iwalk
