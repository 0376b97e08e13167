-- ARGV: losses allowed, error for lost workers, error for jobs nobody started, lease in ms.
-- Ends what nobody else will end: stale leases, expired jobs, dead workers. Returns what was done.
local max_losses, time = tonumber(ARGV[1]), now()
local reaped, expired = 0, 0

local function until_now(line)
  return redis.call('ZRANGEBYSCORE', key(line), '-inf', text(time), 'LIMIT', 0, 100)
end

-- While Redis was away nobody could keep a lease: the living get one lease's time to show up.
local uptime_s = tonumber(string.match(redis.call('INFO', 'server'), 'uptime_in_seconds:(%d+)'))
if uptime_s * 1000 > tonumber(ARGV[4]) then
  for _, id in ipairs(until_now('running')) do
    if redis.call('EXISTS', key('job', id)) == 1 then
      lose(id, max_losses, ARGV[2])
    else
      redis.call('ZREM', key('running'), id)
    end
    reaped = reaped + 1
  end
end
for _, id in ipairs(until_now('expiry')) do
  local status = redis.call('HGET', key('job', id), 'status')
  if status == 'queued' then
    conclude(id, 'failed', 'queue_timeout', {'error', ARGV[3]})
  elseif status == 'running' then
    redis.call('ZADD', key('expiry'), text(time + 60000), id)
  elseif not forget(id) then
    redis.call('ZREM', key('expiry'), id)
    redis.call('ZREM', key('webhooks'), id)
  end
  expired = expired + 1
end
redis.call('ZREMRANGEBYSCORE', key('workers'), '-inf', text(time - 60000))
return {reaped, expired}
