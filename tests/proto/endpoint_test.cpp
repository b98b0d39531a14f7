// SPDX-License-Identifier: MIT
// Where a publisher can be bound and where not, each refusal with its exit code and next step; keys; default places.
#include "proto/endpoint.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>

#include "core/error.hpp"
#include "tests/proto/channels.hpp"

namespace rptv {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// What the constructor throws for these endpoints.
Error refusal(const PublishOptions& options) {
  try {
    const PublishChannel channel(options);
  } catch (const Error& error) {
    return error;
  }
  return {ExitCode::ok, "was not refused"};
}

TEST(PublishChannel, refuses_an_ipc_address_in_use_instead_of_stealing_it) {
  const Place place;
  PublishChannel first(at(place.ipc()));
  const Error error = refusal(at(place.ipc()));
  EXPECT_EQ(error.code(), ExitCode::unavailable);
  EXPECT_THAT(error.what(), AllOf(HasSubstr(place.ipc()), HasSubstr("address already in use")));
  SubscribeChannel subscriber(from(place.ipc()));
  connect(first, subscriber, Topic::tracks);
}

TEST(PublishChannel, refuses_a_tcp_port_in_use) {
  const PublishChannel first(at("tcp://127.0.0.1:*"));
  const Error error = refusal(at(first.endpoints().front()));
  EXPECT_EQ(error.code(), ExitCode::unavailable);
  EXPECT_THAT(error.what(), AllOf(HasSubstr(first.endpoints().front()), HasSubstr("address already in use")));
}

TEST(PublishChannel, takes_over_a_socket_that_a_killed_process_left) {
  const Place place;
  const pid_t child = fork();
  if (child == 0) {
    const PublishChannel channel(at(place.ipc()));
    _exit(0);  // as after kill -9: nobody unlinks the socket
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(std::filesystem::exists(place.file("tracks.sock")));
  PublishChannel publisher(at(place.ipc()));
  SubscribeChannel subscriber(from(place.ipc()));
  connect(publisher, subscriber, Topic::tracks);
}

TEST(PublishChannel, never_replaces_a_file_that_is_no_socket) {
  const Place place;
  place.write("tracks.sock", "precious");
  const Error error = refusal(at(place.ipc()));
  EXPECT_EQ(error.code(), ExitCode::configuration);
  EXPECT_THAT(error.what(), HasSubstr("is no socket"));
  EXPECT_EQ(std::filesystem::file_size(place.file("tracks.sock")), 8U);
}

TEST(PublishChannel, says_when_the_directory_is_missing) {
  const Place place;
  const Error error = refusal(at(place.ipc("missing/tracks.sock")));
  EXPECT_EQ(error.code(), ExitCode::configuration);
  EXPECT_THAT(error.what(), HasSubstr("does not exist"));
}

TEST(PublishChannel, says_when_there_is_no_permission) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become another user";
  const Place place;  // mode 0700
  const pid_t child = fork();
  if (child == 0) {
    if (setresuid(65534, 65534, 65534) != 0) _exit(1);
    const Error error = refusal(at(place.ipc()));
    _exit(std::strstr(error.what(), "no permission") != nullptr ? static_cast<int>(error.code()) : 2);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), static_cast<int>(ExitCode::permission));
}

TEST(PublishChannel, refuses_tcp_beyond_loopback_without_keys) {
  for (const char* endpoint : {"tcp://*:5555", "tcp://0.0.0.0:5555", "tcp://192.168.1.2:5555", "tcp://[::]:5555"}) {
    const Error error = refusal(at(endpoint));
    EXPECT_EQ(error.code(), ExitCode::configuration) << endpoint;
    EXPECT_THAT(error.what(), AllOf(HasSubstr(endpoint), HasSubstr("curve_secret_key_file"), HasSubstr("ssh")));
  }
}

TEST(PublishChannel, refuses_endpoints_that_are_none) {
  const std::string longer = "ipc:///tmp/" + std::string(120, 'x');
  for (const std::string& endpoint :
       {std::string("tracks"), std::string("udp://127.0.0.1:1"), std::string("ipc://"), std::string("tcp://127.0.0.1"),
        std::string("tcp://127.0.0.1:99999"), std::string("tcp://:5555"), std::string("tcp://127.0.0.1:port"), longer})
    EXPECT_EQ(refusal(at(endpoint)).code(), ExitCode::configuration) << endpoint;
}

TEST(PublishChannel, encrypts_tcp_with_curve_and_leaves_ipc_open) {
  // The pair from ZeroMQ's own documentation of CURVE.
  const std::string public_key = "rq:rM>}U?@Lns47E1%kR.o@n%FcmmsL/@{H8]yf7";
  const std::string secret_key = "JTKVSB%%)wK0E.X)V>+}o?pNmC{O&4W4b!Ni{Lh6";
  const Place place;
  PublishOptions options = at("tcp://127.0.0.1:*");
  options.endpoints.push_back(place.ipc());
  options.curve_secret_key = secret_key;
  PublishChannel publisher(options);
  SubscribeOptions trusted = from(publisher.endpoints()[0]);
  trusted.curve_server_key = public_key;
  SubscribeChannel with_key(trusted), without_key(from(publisher.endpoints()[0])), local(from(place.ipc()));
  connect(publisher, with_key, Topic::tracks);
  connect(publisher, local, Topic::tracks, "hello local");
  Topic topic{};
  std::span<const std::byte> body;
  EXPECT_FALSE(without_key.receive(topic, body, 100));
}

TEST(CurveKey, is_read_from_a_private_file_only) {
  const Place place;
  const std::string key = "JTKVSB%%)wK0E.X)V>+}o?pNmC{O&4W4b!Ni{Lh6";
  EXPECT_EQ(read_curve_key(place.write("private", key + "\n")), key);
  const auto code_for = [](const std::filesystem::path& file) {
    try {
      read_curve_key(file);
    } catch (const Error& error) {
      return error.code();
    }
    return ExitCode::ok;
  };
  EXPECT_EQ(code_for(place.write("open", key, 0644)), ExitCode::permission);
  EXPECT_EQ(code_for(place.write("short", "abc")), ExitCode::bad_data);
  EXPECT_EQ(code_for(place.file("missing")), ExitCode::no_input);
}

TEST(Endpoint, defaults_to_the_services_directory_then_the_users_then_tmp) {
  const auto restore = [](const char* name, const char* value) {
    value != nullptr ? setenv(name, value, 1) : unsetenv(name);
  };
  const char* user = std::getenv("XDG_RUNTIME_DIR");
  const std::string saved = user != nullptr ? user : "";
  setenv("RUNTIME_DIRECTORY", "/run/rapidptv:/run/other", 1);
  setenv("XDG_RUNTIME_DIR", "/run/user/7", 1);
  EXPECT_EQ(default_endpoint(), "ipc:///run/rapidptv/tracks.sock");
  unsetenv("RUNTIME_DIRECTORY");
  EXPECT_EQ(default_endpoint(), "ipc:///run/user/7/rapidptv/tracks.sock");
  unsetenv("XDG_RUNTIME_DIR");
  EXPECT_EQ(default_endpoint(), "ipc:///tmp/rapidptv-" + std::to_string(geteuid()) + "/tracks.sock");
  restore("XDG_RUNTIME_DIR", user != nullptr ? saved.c_str() : nullptr);
}

TEST(Endpoint, lists_are_split_at_commas) {
  EXPECT_EQ(split_endpoints("ipc:///a, tcp://127.0.0.1:5 ,"),
            (std::vector<std::string>{"ipc:///a", "tcp://127.0.0.1:5"}));
  EXPECT_THROW(split_endpoints(" , "), Error);
}

}  // namespace
}  // namespace rptv
