-- ARGV: job id. A message for this job is in the broker.
if redis.call('EXISTS', key('job', ARGV[1])) == 0 then return 0 end
redis.call('HSET', key('job', ARGV[1]), 'published_at', text(now()))
return 1
