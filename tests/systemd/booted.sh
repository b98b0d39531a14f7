# SPDX-License-Identifier: MIT
# Runs inside the booted machine, as root: the service becomes ready, tells its state, is watched, restarted and stopped.
set -u

property() { systemctl show rapidptv -p "$1" --value; }

fail() {
  echo "FAILED: $*"
  systemctl status rapidptv --no-pager --full
  journalctl -u rapidptv --no-pager -n 60
  systemctl exit 2
  exit 2
}

# within SECONDS COMMAND...: repeats it until it succeeds.
within() {
  local until=$((SECONDS + $1)); shift
  until "$@"; do [ $SECONDS -lt $until ] || return 1; sleep 0.1; done
}

status_tells_of_frames() { [[ $(property StatusText) =~ ^[1-9][0-9]*\ frames.*\ [1-9][0-9]*\ tracks ]]; }
status_moved_on() { status_tells_of_frames && [ "$(property StatusText)" != "$1" ]; }
restarted() { [ "$(property NRestarts)" = 1 ] && systemctl -q is-active rapidptv; }

systemd-sysusers || fail "sysusers"
systemctl start rapidptv || fail "it did not become ready"
[ "$(ps -o user= -p "$(property MainPID)")" = rapidptv ] || fail "it does not run as user rapidptv"

within 15 status_tells_of_frames || fail "the status does not tell of frames: $(property StatusText)"
first=$(property StatusText)
within 15 status_moved_on "$first" || fail "the status stands still at: $first"
echo "status: $(property StatusText)"

runuser -u nobody -g rapidptv -- rapidptv tail --count 20 --timeout 10 >/tmp/lines || fail "a group member cannot subscribe"
[ "$(wc -l </tmp/lines)" -eq 20 ] || fail "tail printed $(wc -l </tmp/lines) lines"
runuser -u nobody -g nogroup -- rapidptv tail --count 1 --timeout 1 >/dev/null 2>&1 && fail "a stranger can subscribe"

pid=$(property MainPID)
kill -STOP "$pid"  # nobody feeds the watchdog now
within 30 restarted || fail "the watchdog did not bring it back"
[ "$(property MainPID)" != "$pid" ] || fail "still the old process"
within 15 status_tells_of_frames || fail "no frames after the restart"

systemctl stop rapidptv || fail "stop"
[ "$(property Result) $(property ExecMainStatus)" = "success 0" ] || fail "it stopped with $(property Result) $(property ExecMainStatus)"
journalctl -u rapidptv --no-pager -o cat -p err | grep -v -e '^-- ' && fail "errors in the journal"

# A broken configuration: one line in the journal that names the mistake, and no restart.
sed -i '1s/^/nonsense = 1\n/' /etc/rapidptv/rig.toml
systemctl start rapidptv 2>/dev/null && fail "it started with a broken configuration"
[ "$(property ExecMainStatus) $(property NRestarts)" = "78 0" ] || fail "exit $(property ExecMainStatus), $(property NRestarts) restarts"
journalctl -u rapidptv --no-pager -o cat | grep "rig.toml:1:1: unknown key 'nonsense'" || fail "the journal does not name the mistake"
echo "the service behaves"
systemctl exit 42
