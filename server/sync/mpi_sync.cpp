// The one file that calls MPI, from the drawing thread alone, on a communicator of its own. A blocking MPI
// call spins and starves the other ranks of a box with fewer cores than ranks; so everything here is
// non-blocking and polled, but what is done once when the wall starts, and what ranks wait for in every
// frame: that goes without MPI.

#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <list>
#include <optional>
#include <span>
#include <thread>

#include "server/sync/host_links.hpp"
#include "server/sync/host_meeting.hpp"
#include "server/sync/start_watch.hpp"
#include "server/sync/sync.hpp"

namespace iwalk {
namespace {

constexpr int kTileTag = 1, kStopTag = 2, kVoteTag = 3;
constexpr int kLongestPause = 1000;  // us
constexpr std::chrono::seconds kToLink{10}, kToBeEnded{2};
constexpr std::uint32_t kTileMagic = 0x4C545749;  // "IWTL"
constexpr std::uint64_t kMaxTileBytes = std::uint64_t{1} << 30;

// Goes before a captured tile's bytes in one message.
struct TileHeader {
    std::uint32_t magic = kTileMagic;
    std::uint32_t tile = 0;
    std::uint64_t sequence = 0;
    std::uint32_t kind = 0;
    std::uint32_t reserved = 0;
};
static_assert(sizeof(TileHeader) == 24);
static_assert(std::is_trivially_copyable_v<protocol::TileStats>);
static_assert(sizeof(FrameState) <= HostMeeting::kMostBytes);

// Open MPI's own error handler ends all ranks with a message; what comes back here is only ever success.
void must(int code) {
    CHECK_OP(code, ==, MPI_SUCCESS);
}

[[noreturn]] void endAll() {
    MPI_Abort(MPI_COMM_WORLD, EXIT_FAILURE);
    std::_Exit(EXIT_FAILURE);
}

int byteCount(std::size_t bytes) {
    CHECK_OP(bytes, <=, kMaxTileBytes);
    return static_cast<int>(bytes);
}

// Sleeps that grow: short waits end quickly, long ones cost next to nothing.
class Patience {
  public:
    void wait() {
        std::this_thread::sleep_for(std::chrono::microseconds(pause_));
        pause_ = std::min(kLongestPause, pause_ + pause_ / 2);
    }

  private:
    int pause_ = 20;  // us
};

class MpiSync : public Sync {
  public:
    explicit MpiSync(int timeout) : timeout_(timeout) {
        must(MPI_Comm_dup(MPI_COMM_WORLD, &world_));
        must(MPI_Comm_rank(world_, &rank_));
        must(MPI_Comm_size(world_, &size_));
        joinHost();
    }
    ~MpiSync() override {
        drain();
        leaveHost();
        MPI_Comm_free(&world_);
        MPI_Finalize();
    }

    void setIdleWork(std::function<void()> work) override { idleWork_ = std::move(work); }

    int rank() const override { return rank_; }
    int size() const override { return size_; }

    bool agree(bool mine) override;
    const std::vector<std::string>& hosts() const override { return hosts_; }
    std::vector<std::string> gatherText(const std::string& mine) override;
    void renumber(int rank, std::vector<int> tiles) override;

    void askToStop() override;
    bool askedToStop() override;

    void broadcast(FrameState& state) override {
        meet(std::as_writable_bytes(std::span(&state, 1)));
        CHECK_OP(state.magic, ==, FrameState::kMagic);
        CHECK_OP(state.version, ==, FrameState::kVersion);
    }

    double barrier() override;

    std::vector<protocol::TileStats> gather(const std::vector<protocol::TileStats>& mine) override;

    void sendToRank0(protocol::TileImage tile) override;
    std::vector<protocol::TileImage> poll() override;

  private:
    struct Outgoing {
        std::vector<std::byte> bytes;
        MPI_Request request = MPI_REQUEST_NULL;
    };

    void finish(MPI_Request& request) {
        Patience patience;
        for (int done = 0; must(MPI_Test(&request, &done, MPI_STATUS_IGNORE)), !done;) {
            if (idleWork_) idleWork_();
            patience.wait();
        }
    }
    void meet(std::span<std::byte> bytes);
    void joinHost();
    void linkHosts(const std::vector<int>& guests);
    void leaveHost();
    bool collectVotes();
    [[noreturn]] void nameMissing(const std::vector<MPI_Request>& votes);
    template <class T>
    void need(const Result<T>& done);
    void dropSent();
    void drain();

    const int timeout_;  // s
    MPI_Comm world_ = MPI_COMM_NULL;
    int rank_ = 0, size_ = 1;
    std::vector<std::string> hosts_;  // by rank
    std::vector<int> tiles_;          // likewise: how many it draws
    MPI_Win hostMemory_ = MPI_WIN_NULL;
    std::optional<HostMeeting> host_;
    std::optional<HostLinks> links_;  // a host's leader's, when there is more than one host
    std::function<void()> idleWork_;
    std::list<Outgoing> outgoing_;          // a list: MPI reads the bytes where they are
    std::vector<protocol::TileImage> own_;  // rank 0's, which need no MPI
    bool stopAsked_ = false;
};

// All come, then rank 0's bytes go to all: on each host in the memory of its ranks, between hosts over TCP.
void MpiSync::meet(std::span<std::byte> bytes) {
    if (!host_->leads()) return host_->follow(bytes, idleWork_);
    host_->gather(idleWork_);
    if (links_) need(rank_ == 0 ? links_->lead(bytes, idleWork_) : links_->follow(bytes, idleWork_));
    host_->release(bytes);
}

// mpirun ends all when a process dies, and says which; this rank does it only where none did.
template <class T>
void MpiSync::need(const Result<T>& done) {
    if (done) return;
    std::fprintf(stderr, "iwalk-server: rank %d on %s: %s\n", rank_,
                 hosts_[static_cast<std::size_t>(rank_)].c_str(), done.error().message.c_str());
    std::this_thread::sleep_for(kToBeEnded);
    endAll();
}

double MpiSync::barrier() {
    const auto start = std::chrono::steady_clock::now();
    meet({});
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

bool MpiSync::agree(bool mine) {
    int vote = mine ? 1 : 0;
    MPI_Request request;
    if (rank_ == 0) {
        const bool others = collectVotes();
        vote = mine && others ? 1 : 0;
    } else {
        must(MPI_Isend(&vote, 1, MPI_INT, 0, kVoteTag, world_, &request));
        finish(request);
    }
    must(MPI_Ibcast(&vote, 1, MPI_INT, 0, world_, &request));
    finish(request);
    return vote == 1;
}

// Whether all others say true, on rank 0.
bool MpiSync::collectVotes() {
    const std::size_t others = static_cast<std::size_t>(size_) - 1;
    std::vector<int> votes(others);
    std::vector<MPI_Request> open(others);
    for (std::size_t i = 0; i < others; ++i)
        must(MPI_Irecv(&votes[i], 1, MPI_INT, static_cast<int>(i) + 1, kVoteTag, world_, &open[i]));
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(timeout_);
    Patience patience;
    for (int done = 0; must(MPI_Testall(size_ - 1, open.data(), &done, MPI_STATUSES_IGNORE)), !done;) {
        if (std::chrono::steady_clock::now() > end) nameMissing(open);
        patience.wait();
    }
    return std::all_of(votes.begin(), votes.end(), [](int vote) { return vote == 1; });
}

void MpiSync::nameMissing(const std::vector<MPI_Request>& votes) {
    std::string missing;
    for (std::size_t i = 0; i < votes.size(); ++i) {
        MPI_Request vote = votes[i];
        int there = 0;
        must(MPI_Request_get_status(vote, &there, MPI_STATUS_IGNORE));
        if (!there)
            missing += fmt::format("{}rank {} on {}", missing.empty() ? "" : ", ", i + 1, hosts_[i + 1]);
    }
    std::fprintf(stderr, "iwalk-server: not ready within %d s: %s\n", timeout_, missing.c_str());
    endAll();
}

std::vector<std::string> MpiSync::gatherText(const std::string& mine) {
    constexpr int kSlot = kMaxText + 1;
    std::vector<char> slot(kSlot, '\0'), all(kSlot * static_cast<std::size_t>(size_));
    std::memcpy(slot.data(), mine.data(), std::min(mine.size(), kMaxText));
    MPI_Request request;
    must(MPI_Iallgather(slot.data(), kSlot, MPI_CHAR, all.data(), kSlot, MPI_CHAR, world_, &request));
    finish(request);
    std::vector<std::string> texts;
    for (std::size_t at = 0; at < all.size(); at += kSlot) texts.emplace_back(all.data() + at);
    return texts;
}

void MpiSync::renumber(int rank, std::vector<int> tiles) {
    CHECK_OP(tiles.size(), ==, hosts_.size());
    tiles_ = std::move(tiles);
    MPI_Comm renumbered = MPI_COMM_NULL;
    must(MPI_Comm_split(world_, 0, rank, &renumbered));
    leaveHost();
    must(MPI_Comm_free(&world_));
    world_ = renumbered;
    must(MPI_Comm_rank(world_, &rank_));
    CHECK_OP(rank_, ==, rank);
    joinHost();
}

// The rank with the lowest number leads: rank 0 its own host.
void MpiSync::joinHost() {
    hosts_ = gatherText(hostName());
    MPI_Comm host = MPI_COMM_NULL;
    int rank = 0, ranks = 0, unit = 0;
    must(MPI_Comm_split_type(world_, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &host));
    must(MPI_Comm_rank(host, &rank));
    must(MPI_Comm_size(host, &ranks));
    auto size = static_cast<MPI_Aint>(rank == 0 ? HostMeeting::bytesFor(ranks) : 0);
    void* memory = nullptr;
    must(MPI_Win_allocate_shared(size, 1, MPI_INFO_NULL, host, &memory, &hostMemory_));
    must(MPI_Win_shared_query(hostMemory_, 0, &size, &unit, &memory));
    if (rank == 0) HostMeeting::prepare(memory, ranks);
    must(MPI_Comm_free(&host));
    host_.emplace(memory, rank, ranks);

    std::vector<int> leads(static_cast<std::size_t>(size_));
    const int mine = host_->leads();
    MPI_Request request;  // what is prepared is used after this
    must(MPI_Iallgather(&mine, 1, MPI_INT, leads.data(), 1, MPI_INT, world_, &request));
    finish(request);
    std::vector<int> guests;
    for (int i = 1; i < size_; ++i)
        if (leads[static_cast<std::size_t>(i)]) guests.push_back(i);
    if (!guests.empty()) linkHosts(guests);
}

// The hosts' leaders with rank 0.
void MpiSync::linkHosts(const std::vector<int>& guests) {
    std::string invitation;
    if (host_->leads()) links_.emplace();
    if (rank_ == 0) {
        const Result<std::string> invited = links_->invite();
        need(invited);
        invitation = *invited;
    }
    invitation = gatherText(invitation).front();
    if (rank_ == 0) need(links_->welcome(guests, kToLink));
    if (rank_ != 0 && links_) need(links_->join(invitation, rank_, kToLink));
}

void MpiSync::leaveHost() {
    links_.reset();
    host_.reset();
    must(MPI_Win_free(&hostMemory_));
}

std::vector<protocol::TileStats> MpiSync::gather(const std::vector<protocol::TileStats>& mine) {
    constexpr int kEach = sizeof(protocol::TileStats);
    CHECK_OP(mine.size(), ==, static_cast<std::size_t>(tiles_[static_cast<std::size_t>(rank_)]));
    std::vector<protocol::TileStats> all;
    std::vector<int> bytes, places;
    if (rank_ == 0) {
        int place = 0;
        for (const int count : tiles_) {
            bytes.push_back(count * kEach);
            places.push_back(place);
            place += bytes.back();
        }
        all.resize(static_cast<std::size_t>(place / kEach));
    }
    MPI_Request request;
    must(MPI_Igatherv(mine.data(), static_cast<int>(mine.size()) * kEach, MPI_BYTE, all.data(), bytes.data(),
                      places.data(), MPI_BYTE, 0, world_, &request));
    finish(request);
    return all;
}

void MpiSync::askToStop() {
    if (std::exchange(stopAsked_, true) || rank_ == 0) return;
    Outgoing& outgoing = outgoing_.emplace_back();
    must(MPI_Isend(outgoing.bytes.data(), 0, MPI_BYTE, 0, kStopTag, world_, &outgoing.request));
}

bool MpiSync::askedToStop() {
    int waiting = 0;
    must(MPI_Iprobe(MPI_ANY_SOURCE, kStopTag, world_, &waiting, MPI_STATUS_IGNORE));
    if (!waiting) return stopAsked_;
    must(MPI_Recv(nullptr, 0, MPI_BYTE, MPI_ANY_SOURCE, kStopTag, world_, MPI_STATUS_IGNORE));  // it is there
    return stopAsked_ = true;
}

void MpiSync::sendToRank0(protocol::TileImage tile) {
    if (rank_ == 0) {
        own_.push_back(std::move(tile));
        return;
    }
    TileHeader header;
    header.tile = tile.tile;
    header.sequence = tile.sequence;
    header.kind = static_cast<std::uint32_t>(tile.kind);
    Outgoing& outgoing = outgoing_.emplace_back();
    outgoing.bytes.resize(sizeof header + tile.bytes.size());
    std::memcpy(outgoing.bytes.data(), &header, sizeof header);
    std::memcpy(outgoing.bytes.data() + sizeof header, tile.bytes.data(), tile.bytes.size());
    must(MPI_Isend(outgoing.bytes.data(), byteCount(outgoing.bytes.size()), MPI_BYTE, 0, kTileTag, world_,
                   &outgoing.request));
}

std::vector<protocol::TileImage> MpiSync::poll() {
    dropSent();
    std::vector<protocol::TileImage> arrived = std::move(own_);
    own_.clear();
    if (rank_ != 0) return arrived;
    while (true) {
        int waiting = 0, count = 0;
        MPI_Message message;
        MPI_Status status;
        must(MPI_Improbe(MPI_ANY_SOURCE, kTileTag, world_, &waiting, &message, &status));
        if (!waiting) return arrived;
        must(MPI_Get_count(&status, MPI_BYTE, &count));
        std::vector<std::byte> bytes(static_cast<std::size_t>(count));
        MPI_Request request;
        must(MPI_Imrecv(bytes.data(), count, MPI_BYTE, &message, &request));
        Patience patience;  // the sender has it ready: no idle work, which may be what called us
        for (int done = 0; must(MPI_Test(&request, &done, MPI_STATUS_IGNORE)), !done;) patience.wait();
        TileHeader header;
        CHECK_OP(bytes.size(), >=, sizeof header);
        std::memcpy(&header, bytes.data(), sizeof header);
        CHECK_OP(header.magic, ==, kTileMagic);
        bytes.erase(bytes.begin(), bytes.begin() + sizeof header);
        arrived.push_back(
            {header.sequence, header.tile, static_cast<protocol::ImageKind>(header.kind), std::move(bytes)});
    }
}

void MpiSync::dropSent() {
    for (auto outgoing = outgoing_.begin(); outgoing != outgoing_.end();) {
        int sent = 0;
        must(MPI_Test(&outgoing->request, &sent, MPI_STATUS_IGNORE));
        outgoing = sent ? outgoing_.erase(outgoing) : std::next(outgoing);
    }
}

// MPI must not be finalised with messages under way: each rank comes to a last barrier when its tiles are
// gone, and rank 0 takes them in meanwhile.
void MpiSync::drain() {
    for (Patience patience; dropSent(), !outgoing_.empty();) patience.wait();
    MPI_Request request;
    must(MPI_Ibarrier(world_, &request));
    idleWork_ = [this] { poll(), askedToStop(); };
    finish(request);
}

}  // namespace

Result<std::unique_ptr<Sync>> startMpi(int& argc, char**& argv, int timeout) {
    const StartWatch watch(timeout);
    // MPI asks hwloc for the machine, and that an X server, whose end in that moment would be this rank's.
    setenv("HWLOC_COMPONENTS", "-gl", 0);
    int provided = MPI_THREAD_SINGLE;
    if (MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided) != MPI_SUCCESS ||
        provided < MPI_THREAD_FUNNELED)
        return fail("MPI does not start with threads: iwalk-server needs Open MPI (Debian: openmpi-bin)");
    return std::unique_ptr<Sync>(std::make_unique<MpiSync>(timeout));
}

}  // namespace iwalk
