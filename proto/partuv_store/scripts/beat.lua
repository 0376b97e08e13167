-- ARGV: job id, attempt, lease in ms, stage, progress. Keeps the lease and tells how the job goes.
-- Returns go, cancel, or lost (the job is in other hands, finished or forgotten).
local id = ARGV[1]
local job = key('job', id)
if not owns(id, ARGV[2]) then return 'lost' end
redis.call('ZADD', key('running'), text(now() + tonumber(ARGV[3])), id)
local stage, progress = unpack(redis.call('HMGET', job, 'stage', 'progress'))
local further = math.max(tonumber(progress), tonumber(ARGV[5]))
if ARGV[4] ~= stage or further > tonumber(progress) then
  redis.call('HSET', job, 'stage', ARGV[4], 'progress', string.format('%.4f', further))
  touch(id)
end
if redis.call('HGET', job, 'cancel_requested') then return 'cancel' end
return 'go'
