-- ARGV: job id, delivery as JSON, ms until the next try (-1: none), outcome.
-- The delivery goes to the log on the job.
local job = key('job', ARGV[1])
local log = redis.call('HGET', job, 'deliveries')
if redis.call('EXISTS', job) == 0 then
  redis.call('ZREM', key('webhooks'), ARGV[1])
  return 0
end
redis.call('HSET', job, 'deliveries',
  log and (string.sub(log, 1, -2) .. ',' .. ARGV[2] .. ']') or ('[' .. ARGV[2] .. ']'))
if tonumber(ARGV[3]) < 0 then
  redis.call('ZREM', key('webhooks'), ARGV[1])
else
  redis.call('ZADD', key('webhooks'), text(now() + tonumber(ARGV[3])), ARGV[1])
end
count('webhooks:' .. ARGV[4])
touch(ARGV[1])
return 1
