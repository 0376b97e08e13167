-- ARGV: job id, worker, lease in ms. Returns {outcome, record}; outcomes: claimed, taken, gone.
local id, worker = ARGV[1], ARGV[2]
local job = key('job', id)
local status, current = unpack(redis.call('HMGET', job, 'status', 'worker'))
if not status then return {'gone', {}} end
if status == 'queued' then
  local time = now()
  redis.call('HINCRBY', job, 'attempt', 1)
  redis.call('HSET', job, 'status', 'running', 'worker', worker)
  if redis.call('HSETNX', job, 'started_at', text(time)) == 1 then
    observe_seconds('wait_seconds', (time - tonumber(redis.call('HGET', job, 'created_at'))) / 1000)
  end
  redis.call('ZREM', key('waiting'), id)
  redis.call('ZADD', key('running'), text(time + tonumber(ARGV[3])), id)
  touch(id)
elseif status ~= 'running' or current ~= worker then
  return {'taken', {}}
end
return {'claimed', redis.call('HGETALL', job)}
