-- ARGV: job id. Returns the status: canceled at once where it waited, else as it is.
local job = key('job', ARGV[1])
local status = redis.call('HGET', job, 'status')
if status == 'queued' then
  conclude(ARGV[1], 'canceled', '', {})
  return 'canceled'
elseif status == 'running' and redis.call('HSETNX', job, 'cancel_requested', '1') == 1 then
  touch(ARGV[1])
end
return status
